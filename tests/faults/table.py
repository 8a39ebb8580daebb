#!/usr/bin/python3
"""Runs the fault tests and writes what they measured into docs/fault_matrix.md:

    tests/faults/table.py [RECORD]      # RECORD: of an earlier run, instead of running them
"""
import collections
import json
import os
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
PAGE = HERE.parents[1] / "docs" / "fault_matrix.md"
MARK = "<!-- measured: tests/faults/table.py writes from here on -->"

SILENT = {0: "(the run goes on to its end)", 130: "(ended by its user)"}


def measure():
    with tempfile.NamedTemporaryFile("r", suffix=".jsonl") as record:
        subprocess.run(["/usr/bin/python3", "-m", "unittest", "discover", "-s", HERE], check=True,
                       cwd=HERE, env={**os.environ, "UNDERTOW_FAULT_RECORD": record.name,
                                      "PYTHONDONTWRITEBYTECODE": "1"})
        return record.read()


def main():
    text = pathlib.Path(sys.argv[1]).read_text() if len(sys.argv) > 1 else measure()
    tests = collections.defaultdict(list)
    for line in text.splitlines():
        entry = json.loads(line)
        tests[(entry["row"], entry["file"], entry["test"])].append(entry)
    lines = [MARK, "", "## Measured", "",
             "Exit code and time from the fault to the end of each program, and the sentence that its user",
             "reads. A test with several variants shows the first.", "",
             "| row | test | program | exit | ends after | sentence |", "|---|---|---|---|---|---|"]
    for (row, file, test), entries in sorted(tests.items()):
        seen = set()
        for entry in entries:
            if entry.get("who") in seen:
                continue
            seen.add(entry.get("who"))
            place = f"`{file[5:]}.{test[5:]}`"
            if entry["text"]:
                lines.append(f"| {row} | {place} | all | | | {entry['text']} |")
                continue
            sentence = entry["sentence"].replace("|", "\\|") or SILENT.get(entry["code"], "")
            lines.append(f"| {row} | {place} | {entry['who']} | {entry['code']} | "
                         f"{entry['seconds']:.2f} s | {sentence} |")
    page = PAGE.read_text(encoding="ascii").split(MARK)[0]
    PAGE.write_text(page + "\n".join(lines) + "\n", encoding="ascii")


if __name__ == "__main__":
    main()
