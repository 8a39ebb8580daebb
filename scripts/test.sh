#!/usr/bin/env bash
# scripts/test.sh [--quick|--long]: sets up, builds and runs the tests; fails when a test fails.
# --quick leaves out the tests labeled slow (whole cases); --long adds those labeled long.
set -euo pipefail
cd "$(dirname "$0")/.."

leave_out=(-LE '^long$')
case "${1:-}" in
    "") ;;
    --quick) leave_out=(-LE '^(long|slow)$') ;;
    --long) leave_out=() ;;
    -h | --help) sed -n '2,3s/^# //p' "$0"; exit 0 ;;
    *) echo "scripts/test.sh knows --quick and --long, but got: $1" >&2; exit 2 ;;
esac

scripts/setup.sh --tests
exec ctest --test-dir "${UNDERTOW_BUILD:-build}" --output-on-failure -j2 "${leave_out[@]}"
