#!/usr/bin/python3
"""Mesh recipe: three lanes beside each other, in each a thin wall between two blocks of soil. Writes mesh/skirts_N.msh for N = 4,
8, 16 elements over the depth, and mesh/shells_8.msh, whose walls are shells.

Volume sets soil, skirt (of shells a set of quads); facet sets a_soil, a_skirt (b, c: the other lanes) for both sides of the wall; node sets sides, bottom.
"""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from solid_mesh import SolidMesh

DEPTH, WIDTH, LANE, HALF_WALL, GAP = 1.0, 0.5, 0.25, 0.01, 2e-3      # [m]


def sheet(mesh, lane, low):
    """The wall as shells in its middle plane."""
    y, z = np.linspace(low, low + LANE, 3), np.linspace(-DEPTH - 0.1, 0.1, 9)
    nodes = mesh.sheet("skirt", [[(0, b, c) for c in z] for b in y])
    mesh.face(f"{lane}_skirt", nodes)


def build(n, shells=False):
    mesh = SolidMesh()
    for k, lane in enumerate("abc"):
        low = 2 * k * LANE
        if shells:
            sheet(mesh, lane, low)
        wall = None if shells else mesh.box("skirt", (-HALF_WALL, low, -DEPTH - 0.1), (HALF_WALL, low + LANE, 0.1), (1, 1, 4))
        inner = HALF_WALL + GAP
        left = mesh.box("soil", (-WIDTH - inner, low, -DEPTH), (-inner, low + LANE, 0), (n // 2, max(n // 4, 1), n))
        right = mesh.box("soil", (inner, low, -DEPTH), (WIDTH + inner, low + LANE, 0), (n // 2, max(n // 4, 1), n))
        for soil, side, near, far in ((left, 0, -1, 0), (right, -1, 0, -1)):
            if not shells:
                mesh.face(f"{lane}_skirt", wall[side])
            mesh.face(f"{lane}_soil", soil[near])
            mesh.face("sides", soil[far])
            mesh.face("bottom", soil[:, :, 0])
    return mesh


if __name__ == "__main__":
    for n in (4, 8, 16):
        build(n).write(Path(__file__).resolve().parent / "mesh" / f"skirts_{n}.msh")
    build(8, shells=True).write(Path(__file__).resolve().parent / "mesh" / "shells_8.msh")
