#!/usr/bin/python3
"""Seeds of the fuzzers: golden vectors for the codec, case files for the reader.

    seeds.py codec|case FOLDER
"""
import pathlib
import struct
import sys

TOP = pathlib.Path(__file__).resolve().parents[2]


def multipart(path):
    """A golden vector in the form that codec.cpp takes."""
    frames = [b"" if line == "-" else bytes.fromhex(line)
              for line in path.read_text(encoding="ascii").splitlines() if not line.startswith("#")]
    head = struct.pack("<B", len(frames) - 1) + b"".join(struct.pack("<H", len(frame)) for frame in frames)
    return head + b"".join(frames)


def main():
    kind, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    if kind == "codec":
        for path in sorted((TOP / "tests" / "golden" / "protocol_v1").glob("*.hex")):
            (folder / path.stem).write_bytes(multipart(path))
    else:
        for number, path in enumerate(sorted([*TOP.glob("cases/**/*.toml"), *TOP.glob("tests/**/*.toml")])):
            (folder / f"{number}-{path.parent.name}").write_bytes(path.read_bytes())


if __name__ == "__main__":
    main()
