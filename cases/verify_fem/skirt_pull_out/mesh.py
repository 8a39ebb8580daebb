#!/usr/bin/python3
"""Mesh recipe: three lanes beside each other, in each a thin wall between two blocks of soil. Writes mesh/skirts_N.msh for N = 4,
8, 16 elements over the depth.

Volume sets soil, skirt; facet sets a_soil, a_skirt (b, c: the other lanes) for both sides of the wall; node sets sides, bottom.
"""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from solid_mesh import SolidMesh

DEPTH, WIDTH, LANE, HALF_WALL, GAP = 1.0, 0.5, 0.25, 0.01, 2e-3      # [m]


def build(n):
    mesh = SolidMesh()
    for k, lane in enumerate("abc"):
        low = 2 * k * LANE
        wall = mesh.box("skirt", (-HALF_WALL, low, -DEPTH - 0.1), (HALF_WALL, low + LANE, 0.1), (1, 1, 4))
        inner = HALF_WALL + GAP
        left = mesh.box("soil", (-WIDTH - inner, low, -DEPTH), (-inner, low + LANE, 0), (n // 2, max(n // 4, 1), n))
        right = mesh.box("soil", (inner, low, -DEPTH), (WIDTH + inner, low + LANE, 0), (n // 2, max(n // 4, 1), n))
        for soil, own, near, far in ((left, wall[0], -1, 0), (right, wall[-1], 0, -1)):
            mesh.face(f"{lane}_skirt", own)
            mesh.face(f"{lane}_soil", soil[near])
            mesh.face("sides", soil[far])
            mesh.face("bottom", soil[:, :, 0])
    return mesh


if __name__ == "__main__":
    for n in (4, 8, 16):
        build(n).write(Path(__file__).resolve().parent / "mesh" / f"skirts_{n}.msh")
