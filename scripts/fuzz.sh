#!/usr/bin/env bash
# scripts/fuzz.sh codec|case [INPUTS]: feeds the reader of messages or of case files with INPUTS mutated inputs
# (default: a million), under address and undefined-behavior sanitizers and a limit of memory. What breaks it is
# kept in build-fuzz/. Needs clang.
set -euo pipefail
cd "$(dirname "$0")/.."

part=${1:-}
inputs=${2:-1000000}
case "$part" in
    codec) sources=(protocol/wire/{message,encode,decode,header_reader,session,data_check}.cpp) options=(-max_len=4096) ;;
    case) sources=($(ls protocol/case/*.cpp | grep -v -e /main.cpp -e case_json -e program_options)
                   protocol/wire/failure.cpp) options=(-max_len=16384 -dict=tests/fuzz/case.dict) ;;
    -h | --help) sed -n '2,4s/^# //p' "$0"; exit 0 ;;
    *) echo "scripts/fuzz.sh knows codec and case, but got: ${part:-nothing}" >&2; exit 2 ;;
esac
command -v clang++ >/dev/null || { echo "scripts/fuzz.sh needs clang++ (Debian: clang)" >&2; exit 2; }

folder=build-fuzz
mkdir -p "$folder/$part.found" "$folder/$part.corpus"
binary=$folder/fuzz_$part
if [[ ! -x $binary || -n $(find protocol tests/fuzz scripts/fuzz.sh -newer "$binary" -print -quit) ]]; then
    flags=(-std=c++20 -O1 -g1 -fsanitize=address,undefined -fno-sanitize-recover=undefined -Iprotocol
           -DMSGPACK_NO_BOOST $(pkg-config --cflags tomlplusplus))
    objects=()
    for source in "tests/fuzz/$part.cpp" "${sources[@]}"; do
        objects+=("$folder/$part.$(basename "$source" .cpp).o")
        clang++ "${flags[@]}" -fsanitize=fuzzer-no-link -c "$source" -o "${objects[-1]}"
    done
    clang++ "${flags[@]}" -fsanitize=fuzzer "${objects[@]}" -lmuparser $(pkg-config --libs tomlplusplus) -o "$binary"
fi

/usr/bin/python3 tests/fuzz/seeds.py "$part" "$folder/$part.seeds"
exec "$binary" "$folder/$part.corpus" "$folder/$part.seeds" -runs="$inputs" -seed=1 -rss_limit_mb=512 \
    -malloc_limit_mb=128 -timeout=10 -artifact_prefix="$folder/$part.found/" -print_final_stats=1 "${options[@]}"
