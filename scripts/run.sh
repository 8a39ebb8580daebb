#!/usr/bin/env bash
# scripts/run.sh [CASE] [options]: sets up and builds if needed, then runs a case and reports.
# CASE is a folder with a case.toml or a .toml file; without it, cases/dam_break.
# Options are those of "scripts/undertow run", such as --level quick, --with VARIANT, --set key=value.
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)

case "${1:-}" in
    -h | --help) sed -n '2,4s/^# //p' "$0"; exit 0 ;;
    "" | -*) set -- "$top/cases/dam_break" "$@" ;;
esac

log=$(mktemp)
trap 'rm -f "$log"' EXIT
if [[ -t 1 ]]; then
    "$top/scripts/setup.sh"
else
    # Only failures of the build are worth a reader's time in a log.
    "$top/scripts/setup.sh" >"$log" 2>&1 || { cat "$log" >&2; exit 1; }
fi
rm -f "$log"
exec "$top/scripts/undertow" run "$@"
