#!/usr/bin/env bash
# scripts/bench.sh sph|fem|coupling [--json FILE]: builds and runs a benchmark; its figures on the screen, and
# as {"key": number, ...} in FILE, where keys that are there already and are not measured now stay.
# coupling: messages of one step by shm, ipc and tcp [us], and what coupling adds to a run. Contact: build/bin/bench_contact_cost.
set -euo pipefail
cd "$(dirname "$0")/.."

part=${1:-}
case "$part" in
    sph | fem) bench=bench_${part}_throughput && shift ;;
    coupling) bench=bench_wire_latency && shift ;;
    -h | --help) sed -n '2,4s/^# //p' "$0"; exit 0 ;;
    *) echo "scripts/bench.sh knows sph, fem and coupling, but got: ${part:-nothing}" >&2; exit 2 ;;
esac
file=
if [[ ${1:-} == --json && -n ${2:-} ]]; then
    file=$(realpath -m "$2")
    shift 2
fi
if (($#)); then
    echo "scripts/bench.sh $part knows --json FILE only, but got: $*" >&2
    exit 2
fi

build=${UNDERTOW_BUILD:-build}
[[ -f $build/build.ninja ]] || scripts/setup.sh
cmake --build "$build" --target "$bench" >/dev/null
export OMP_WAIT_POLICY=passive GOMP_SPINCOUNT=0
figures=$("$build/bin/$bench" --json)
more='{}'
if [[ $part == coupling ]]; then
    cmake --build "$build" --target programs >/dev/null
    more=$(tests/benchmarks/overhead.py)
fi
if [[ -z $file ]]; then
    echo "$figures"
    [[ $more == '{}' ]] || echo "$more"
    exit
fi
FIGURES=$figures MORE=$more /usr/bin/python3 - "$file" <<'PYTHON'
import json
import os
import pathlib
import sys

path = pathlib.Path(sys.argv[1])
try:
    figures = json.loads(path.read_text())
except FileNotFoundError:
    figures = {}
except json.JSONDecodeError as error:
    sys.exit(f"{path} is there but is not JSON ({error}): name another file.")
figures.update(json.loads(os.environ["FIGURES"]) | json.loads(os.environ["MORE"]))
path.write_text(json.dumps(figures, indent=2) + "\n")
PYTHON
echo "figures in $file"
