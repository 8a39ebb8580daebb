#!/usr/bin/env bash
# scripts/setup.sh: installs what Undertow needs from Debian's own packages and builds it.
# Safe to run again: what is there is kept, and a second run takes a second or two.
# --tests builds the tests as well, --long also gets what only the long tests need (clang for fuzzing, CalculiX to compare with, VTK to open results with); UNDERTOW_BUILD=FOLDER builds elsewhere than in build/.
set -euo pipefail
cd "$(dirname "$0")/.."

targets=(programs)
extra=()
case "${1:-}" in
    "") ;;
    --tests) targets=(all) extra=(python3-getfem python3-scipy) ;;
    --long) targets=(all) extra=(python3-getfem python3-scipy clang calculix-ccx python3-vtk9) ;;
    -h | --help) sed -n '2,4s/^# //p' "$0"; exit 0 ;;
    *) echo "scripts/setup.sh knows --tests and --long, but got: $1" >&2; exit 2 ;;
esac

# tools, C++ libraries, Python for the report and for participants written in it, film
packages=(
    g++ cmake ninja-build
    libeigen3-dev libzmq3-dev cppzmq-dev libmsgpack-cxx-dev libhdf5-dev catch2 libcli11-dev
    libtomlplusplus-dev libmuparser-dev libspdlog-dev libfmt-dev nlohmann-json3-dev
    python3 python3-numpy python3-h5py python3-matplotlib python3-zmq python3-msgpack python3-rich
    ffmpeg
    "${extra[@]}"
)

family=$(. /etc/os-release 2>/dev/null && echo "${ID:-} ${ID_LIKE:-}" || true)
if [[ " $family " != *" debian "* ]] || ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    echo "scripts/setup.sh installs Debian packages, and this system is not Debian (it says: ${family:-nothing});" \
         "install the equivalents of these yourself, then run cmake -S . -B build -G Ninja && cmake --build build:" \
         "${packages[*]}" >&2
    exit 2
fi

missing=()
for package in "${packages[@]}"; do
    [[ $(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true) == installed ]] || missing+=("$package")
done
if ((${#missing[@]})); then
    as_root=()
    if [[ $(id -u) != 0 ]]; then
        if ! command -v sudo >/dev/null; then
            echo "scripts/setup.sh must install packages but is neither root nor finds sudo;" \
                 "ask an administrator for: apt-get install ${missing[*]}" >&2
            exit 2
        fi
        as_root=(sudo)
    fi
    echo "setup: installing ${missing[*]}"
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -q
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}"
fi

# The build is tuned for this processor: on another one it must start afresh, or it would crash with
# an illegal instruction. The stamp also notices another compiler.
build=${UNDERTOW_BUILD:-build}
stamp=$({ grep -m1 '^flags' /proc/cpuinfo || uname -m; g++ -dumpfullversion; pwd; } | md5sum | cut -d' ' -f1)
if [[ $(cat "$build/.stamp" 2>/dev/null || true) != "$stamp" ]]; then
    [[ -f $build/CMakeCache.txt ]] && echo "setup: the build in $build was made elsewhere; building afresh" && rm -rf "$build"
    mkdir -p "$build"
    cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release >"$build/configure.log" 2>&1 || {
        tail -n 20 "$build/configure.log" >&2
        echo "setup: configuring failed; all of it is in $build/configure.log" >&2
        exit 1
    }
    echo "$stamp" >"$build/.stamp"
fi
cmake --build "$build" --target "${targets[@]}"
