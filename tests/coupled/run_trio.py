#!/usr/bin/python3
"""Runs one coupled case with the programs of a build tree and checks its figures.

    run_trio.py FOLDER --bin BUILD/bin

FOLDER holds check.py with check(results), which raises AssertionError, and either case.toml or
`arguments`: a case of cases/ with its options, as `scripts/undertow run` takes them.
Exit code 0: all as expected. Otherwise what failed and the logs are printed.
"""
import argparse
import os
import pathlib
import subprocess
import sys
import tempfile

from run_scenario import check_figures

TOP = pathlib.Path(__file__).resolve().parents[2]
LOGS = ("coupler.log", "sph_solver.log", "fem_solver.log")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    options = parser.parse_args()
    of_case = options.folder / "arguments"
    case = of_case.read_text().split() if of_case.exists() else [options.folder]
    sys.dont_write_bytecode = True
    with tempfile.TemporaryDirectory(prefix="undertow-") as scratch:
        out = pathlib.Path(scratch) / "results"
        ran = subprocess.run(
            [TOP / "scripts" / "undertow", "run", *case, "--out", out, "--quiet"], cwd=TOP,
            env={**os.environ, "UNDERTOW_BUILD": str(options.bin.resolve().parent),
                 "PYTHONDONTWRITEBYTECODE": "1"},
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        complaints = [f"the run ended with {ran.returncode}: {ran.stdout}"] if ran.returncode else []
        complaints = complaints or check_figures(options.folder, out)
        for complaint in complaints:
            print("FAILED:", complaint)
        for name in LOGS if complaints else ():
            path = out / name
            print(f"---- {name}", path.read_text() if path.exists() else "(none)", sep="\n")
        return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
