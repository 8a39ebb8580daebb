#!/usr/bin/python3
"""limits.py RESULTS...: what limits the step of runs that are done, as a table in Markdown.

RESULTS are folders of runs, or folders of such folders (build/verify, results/pareto/NAME). The limiter is
that of most steps, outputs aside; "mesh over elements" is how much the mesh's own largest frequency
allows beyond its elements' bound; "FEM" the time per step in which that program did not wait;
"coupling" the part of the wall time in which the coupler did not wait for the solvers.
"""

import json
import pathlib
import sys


def read(path):
    return json.loads(path.read_text()) if path.exists() else {}


def runs_in(folders):
    for folder in map(pathlib.Path, folders):
        if any(folder.glob("summary.*.json")):
            yield folder
        else:
            yield from (path for path in sorted(folder.iterdir()) if any(path.glob("summary.*.json")))


def limiter_of(coupler, fem):
    own = {who: share for who, share in coupler.get("limiters", {}).items() if who != "output"}
    if not own:
        return fem.get("limiter", "not kept").removeprefix("fem: ")
    who = max(own, key=own.get)
    name = fem.get("limiter", "") if who.startswith("fem") and "#" in who else who
    return f"{name.removeprefix('fem: ')}, {100 * own[who] / sum(own.values()):.0f} % of steps"


def row(folder):
    fem, sph, coupler = (read(folder / f"summary.{p}.json") for p in ("fem", "sph", "coupler"))
    one = coupler or fem or sph
    steps = one["steps"]
    step = one.get("dt_mean")
    gain = fem["dt_critical"] / fem["dt_critical_elements"] if fem.get("dt_critical") else None
    cells = [
        folder.name,
        limiter_of(coupler, fem),
        f"{1e6 * step:.3g} us",
        f"{steps:,}",
        f"{gain:.2f}" if gain else "",
        f"{1e6 * (fem['wall_s'] - fem['wait_s']) / steps:.0f} us" if fem else "",
        "",
    ]
    if coupler:
        share = 1 - coupler["wait_fraction"]
        cells[-1] = f"{100 * share:.1f} %, {1e6 * share * coupler['wall_s'] / steps:.0f} us"
    return cells


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    print("| run | limited by | mean step | steps | mesh over elements | FEM, busy per step | coupling |")
    print("|---|---|---|---|---|---|---|")
    for folder in runs_in(sys.argv[1:]):
        print("| " + " | ".join(row(folder)) + " |")


if __name__ == "__main__":
    main()
