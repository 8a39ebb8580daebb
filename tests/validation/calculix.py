#!/usr/bin/python3
"""Checks the FEM solver against CalculiX (ccx, Debian's calculix-ccx): the same meshes, loads and supports in both.

    tests/validation/calculix.py          prints a table; exit 1 when a difference is larger than allowed
    UNDERTOW_BUILD=FOLDER                 where fem_solver is (default: build)

Ours are runs of `scripts/undertow verify`. Without ccx it says so and ends with exit 77, which ctest shows as skipped.
"""
import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

TOP = Path(__file__).resolve().parents[2]
CASES = TOP / "cases" / "verify_fem"
SKIPPED = 77
sys.path[:0] = [str(TOP / "scripts"), str(CASES)]

from undertow_tool.verify.structure import MeasuredStructure  # noqa: E402


def ours(name, level, folder):
    """The run of a level of a verification."""
    command = [str(TOP / "scripts" / "undertow"), "verify", name, "--level", level, "--quiet", "--out", str(folder)]
    subprocess.run(command, stdout=subprocess.DEVNULL, timeout=300)      # its gates are not judged here
    out = folder / f"{name}-{level}"
    case, summary = (json.loads((out / f"{part}.json").read_text()) for part in ("case", "summary"))
    return MeasuredStructure(out, case, summary)


def recipe(name):
    """The mesh.py of a verification."""
    import importlib.util

    spec = importlib.util.spec_from_file_location(f"{name}_mesh", CASES / name / "mesh.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Deck:
    """Input of ccx; nodes and elements from 0 on, as in our meshes."""

    def __init__(self, x):
        self.lines = ["*NODE"] + [f"{n + 1},{p[0]:.12g},{p[1]:.12g},{p[2]:.12g}" for n, p in enumerate(x)]
        self.elements = 0

    def add(self, *lines):
        self.lines += lines

    def cells(self, name, kind, cells):
        """Elements by their nodes; returns the number of the first."""
        first = self.elements + 1
        self.add(f"*ELEMENT,TYPE={kind},ELSET={name}")
        for cell in cells:
            self.elements += 1
            row = [self.elements, *(int(n) + 1 for n in cell)]
            self.add(*(",".join(map(str, row[k:k + 11])) + ("," if k + 11 < len(row) else "") for k in range(0, len(row), 11)))
        return first

    def nodes(self, name, nodes):
        self.add(f"*NSET,NSET={name}", *(f"{int(n) + 1}," for n in np.unique(nodes)))

    def elastic(self, name, modulus, nu):
        self.add(f"*MATERIAL,NAME={name}", "*ELASTIC", f"{modulus},{nu}", f"*SOLID SECTION,ELSET={name},MATERIAL={name}")

    def run(self):
        """Tables of the .dat file: for each, its numbers (rows, columns)."""
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "deck.inp").write_text("\n".join(self.lines) + "\n")
            done = subprocess.run(["ccx", "deck"], cwd=folder, capture_output=True, text=True, timeout=300)
            result = Path(folder) / "deck.dat"
            if not result.exists():
                raise SystemExit(f"ccx made no results:\n{done.stdout[-2000:]}")
            text = result.read_text()
        tables = []
        for line in text.splitlines():
            try:
                row = [float(word) for word in line.split()]
            except ValueError:
                tables.append([])
                continue
            if row:
                tables[-1].append(row)
        tables = [np.array(table) for table in tables if table]
        if not tables:
            raise SystemExit(f"ccx made no results:\n{done.stdout[-2000:]}")
        return tables


def cooks_membrane(folder):
    """Elastic: deflection of the end. Both are hexahedra of 8 points; ours takes the mean of the change of volume, C3D8 has it
    at each point and is the stiffer for it, so the two meet with the mesh only."""
    run = ours("cooks_membrane", "fine", folder)
    block, material = run.case["fem"]["block"], run.case["fem"]["material"][0]
    (nx, _, nz), corners = block["divisions"], np.array(block["corners"])
    s, t = np.meshgrid(np.arange(nx + 1) / nx, np.arange(nz + 1) / nz, indexing="ij")
    x = np.concatenate([np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t], -1).reshape(-1, 4) @ corners[layer]
                        for layer in ([0, 1, 5, 4], [3, 2, 6, 7])])
    n = np.arange((nx + 1) * (nz + 1)).reshape(nx + 1, nz + 1)
    back = n + n.size
    cells = np.stack([n[:-1, :-1], n[1:, :-1], back[1:, :-1], back[:-1, :-1], n[:-1, 1:], n[1:, 1:], back[1:, 1:], back[:-1, 1:]], -1)
    deck = Deck(x)
    deck.cells("PANEL", "C3D8", cells.reshape(-1, 8))
    deck.nodes("ROOT", np.concatenate([n[0], back[0]]))
    deck.nodes("ALL", np.arange(len(x)))
    deck.nodes("END", np.concatenate([n[-1], back[-1]]))
    deck.elastic("PANEL", material["young_modulus"], material["poisson_ratio"])
    share = np.full(nz + 1, 1.0 / nz)
    share[[0, -1]] *= 0.5
    total = run.case["fem"]["traction"][0]["value"][2] * np.linalg.norm(corners[5] - corners[1]) * run.case["case"]["thickness"]
    deck.add("*BOUNDARY", "ROOT,1,3", "ALL,2,2", "*STEP", "*STATIC", "*CLOAD")
    deck.add(*(f"{node + 1},3,{0.5 * total * w:.12g}" for side in (n, back) for node, w in zip(side[-1], share)))
    deck.add("*NODE PRINT,NSET=END", "U", "*END STEP")
    moved = {int(row[0]) - 1: row[3] for row in deck.run()[-1]}
    for place, node in (("corner", n[-1, -1]), ("middle", n[-1, nz // 2])):
        yield f"Cook's membrane, {nx} x {nz}: deflection of the {place}", "m", run.mean_of_end(f"{place}.uz"), moved[node], 1e-2


def twisted_beam(folder):
    """Shells against quadratic solid elements: compliance of the tips."""
    run = ours("twisted_beam", "fine", folder)
    module, material = recipe("twisted_beam"), run.case["fem"]["material"][0]
    thickness = run.case["fem"]["part"][0]["thickness"]
    counts = (48, 6, 4)
    index, x = {}, []

    def node(i, j, k):
        if (i, j, k) not in index:
            turn = 0.5 * np.pi * i / (2 * counts[0])
            a, b = (j / (2 * counts[1]) - 0.5) * module.WIDTH, (k / (2 * counts[2]) - 0.5) * thickness
            index[i, j, k] = len(x)
            x.append((module.LENGTH * i / (2 * counts[0]), a * np.cos(turn) - b * np.sin(turn), a * np.sin(turn) + b * np.cos(turn)))
        return index[i, j, k]

    places = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2), (1, 0, 0), (2, 1, 0),
              (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2), (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)]
    cells = [[node(2 * i + a, 2 * j + b, 2 * k + c) for a, b, c in places]
             for i in range(counts[0]) for j in range(counts[1]) for k in range(counts[2])]
    for place, tip, axis in (("in", "in", 3), ("out of", "out", 2)):
        deck = Deck(x)
        deck.cells("BEAM", "C3D20R", cells)
        deck.nodes("ROOT", [n for (i, _, _), n in index.items() if i == 0])
        deck.nodes("TIP", [n for (i, _, k), n in index.items() if i == 2 * counts[0] and k == counts[2]])
        deck.elastic("BEAM", material["young_modulus"], material["poisson_ratio"])
        deck.add("*BOUNDARY", "ROOT,1,3", "*STEP", "*STATIC", "*BOUNDARY", f"TIP,{axis},{axis},1e-4",
                 "*NODE PRINT,NSET=TIP,TOTALS=ONLY", "RF", "*END STEP")
        force = deck.run()[-1][0, axis - 1]
        d = "xyz"[axis - 1]
        found = run.mean_of_end(f"motion {tip}.u{d}") / run.mean_of_end(f"motion {tip}.f{d}")
        yield f"twisted beam, shells / C3D20R: compliance {place} the plane", "m/N", found, 1e-4 / force, 5e-3


def hertz_cylinder(folder):
    """Contact: force on a rigid cylinder for the way it is pressed, and how far the surface yields beside it."""
    run = ours("hertz_cylinder", "medium", folder)
    material = run.case["fem"]["material"][0]
    way = -float(run.probe("motion press.uz")[1][-1])
    mesh = recipe("hertz_cylinder").build(8)
    x = np.array(mesh.x)
    deck = Deck(x)
    soil = deck.cells("BLOCK", "C3D8", mesh.hexahedra["block"])
    stamp = deck.cells("STAMP", "C3D8", mesh.hexahedra["cylinder"])
    of_stamp = np.unique(mesh.hexahedra["cylinder"])
    deck.nodes("STAMP", of_stamp)
    deck.nodes("ALL", np.unique(mesh.hexahedra["block"]))
    deck.nodes("MIDDLE", mesh.quads["middle"])
    deck.nodes("BOTTOM", mesh.quads["bottom"])
    deck.nodes("TOP", mesh.quads["top"])
    deck.elastic("BLOCK", material["young_modulus"], material["poisson_ratio"])
    deck.elastic("STAMP", material["young_modulus"], material["poisson_ratio"])

    def faces(name, cells, first, low, level):
        """Elements with their lower (S1) or upper (S2) side in the surface."""
        deck.add(f"*SURFACE,NAME={name},TYPE=ELEMENT")
        for e, cell in enumerate(cells):
            side = cell[:4] if low else cell[4:]
            if level is None or np.all(np.abs(x[side, 2] - level) < 1e-9):
                deck.add(f"{first + e},S{1 if low else 2}")

    faces("BELOW", mesh.hexahedra["block"], soil, False, 0.0)
    faces("FOOT", mesh.hexahedra["cylinder"], stamp, True, None)
    deck.add("*SURFACE INTERACTION,NAME=HARD", "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR", "2e13,1e3",
             "*CONTACT PAIR,INTERACTION=HARD,TYPE=SURFACE TO SURFACE", "BELOW,FOOT",
             "*BOUNDARY", "ALL,2,2", "MIDDLE,1,1", "BOTTOM,3,3", "STAMP,1,2",
             "*STEP,NLGEOM,INC=1000", "*STATIC", "0.1,1,1e-4,0.1", "*BOUNDARY", f"STAMP,3,3,{-way:.12g}",
             "*NODE PRINT,NSET=BOTTOM,TOTALS=ONLY,FREQUENCY=1000", "RF", "*NODE PRINT,NSET=TOP,FREQUENCY=1000", "U", "*END STEP")
    tables = deck.run()
    force, moved = [t for t in tables if t.shape[1] == 3][-1][-1, 2], [t for t in tables if t.shape[1] == 4][-1]
    yield "Hertz's cylinder: force", "N", run.mean_of_end("contact.normal"), abs(force), 0.02
    found, u = run.fields.read(len(run.fields) - 1, "displacement")
    start, top = found - u, x[moved[:, 0].astype(int) - 1]
    for distance in (0.0, 0.012, 0.03):
        mine = np.argmin(np.linalg.norm(start - [distance, 0, 0], axis=1))
        theirs = np.argmin(np.linalg.norm(top - start[mine], axis=1))
        yield f"Hertz's cylinder: surface at x = {1e3 * start[mine, 0]:.3g} mm", "m", u[mine, 2], moved[theirs, 3], 0.02


PROBLEMS = (cooks_membrane, twisted_beam, hertz_cylinder)


def main():
    if shutil.which("ccx") is None:
        print("skipped: ccx is not installed; it is in Debian's package calculix-ccx: apt-get install calculix-ccx")
        return SKIPPED
    worst = True
    print("| quantity | unit | ours | CalculiX | difference | allowed |\n|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for problem in PROBLEMS:
            for what, unit, mine, theirs, allowed in problem(Path(folder)):
                difference = mine / theirs - 1
                good = abs(difference) <= allowed
                worst &= good
                print(f"| {what} | {unit} | {mine:.5g} | {theirs:.5g} | {100 * difference:+.2f} % | "
                      f"{100 * allowed:g} %{'' if good else ' FAILS'} |", flush=True)
    return 0 if worst else 1


if __name__ == "__main__":
    sys.exit(main())
