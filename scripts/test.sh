#!/usr/bin/env bash
# scripts/test.sh [--quick|--long]: sets up, builds and runs the tests; fails when a test fails.
# First the unit tests in a build with address and undefined-behavior sanitizers, then all tests in the
# usual build. --quick leaves out the sanitizers and the tests labeled slow or validation (whole cases);
# --long adds those labeled long.
set -euo pipefail
cd "$(dirname "$0")/.."

leave_out=(-LE '^long$')
sanitize=1
setup=--tests
case "${1:-}" in
    "") ;;
    --quick)
        leave_out=(-LE '^(long|slow|validation)$')
        sanitize=0
        ;;
    --long) leave_out=() setup=--long ;;
    -h | --help) sed -n '2,5s/^# //p' "$0"; exit 0 ;;
    *) echo "scripts/test.sh knows --quick and --long, but got: $1" >&2; exit 2 ;;
esac

# two tests of two threads each on two cores: threads that spin while they wait take minutes for seconds
export OMP_WAIT_POLICY=passive GOMP_SPINCOUNT=0
scripts/setup.sh "$setup"
if ((sanitize)); then
    build=build-sanitize
    [[ -f $build/build.ninja ]] || cmake -S . -B "$build" -G Ninja -DUNDERTOW_SANITIZE=ON >/dev/null
    cmake --build "$build" --target unit_tests
    # a physics test of minutes under sanitizers finds no more than one of seconds
    ctest --test-dir "$build" --output-on-failure -j2 -LE '^(long|slow)$' \
        -E 'at rest|rearranges|as quiet as|nothing tunnels|frequency with the mesh|100,000 steps|brute force'
fi
exec ctest --test-dir "${UNDERTOW_BUILD:-build}" --output-on-failure -j2 "${leave_out[@]}"
