#!/usr/bin/python3
"""Mesh recipe: two blocks on a rigid plate, for two coefficients of friction. Writes mesh/blocks_N.msh for N = 2, 4, 8 elements along an
edge of the blocks.

Volume sets plate, left, right; facet sets plate_top, left_foot, right_foot.
"""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from solid_mesh import SolidMesh

SIDE, GAP = 0.2, 1e-3      # [m]


def build(n):
    mesh = SolidMesh()
    plate = mesh.box("plate", (-0.6, -0.4, -0.1), (1.0, 0.6, -GAP), (2, 1, 1))
    mesh.face("plate_top", plate[:, :, -1])
    for name, x in (("left", 0.0), ("right", 0.4)):
        block = mesh.box(name, (x, 0, 0), (x + SIDE, SIDE, SIDE), (n, n, n))
        mesh.face(f"{name}_foot", block[:, :, 0])
    return mesh


if __name__ == "__main__":
    for n in (2, 4, 8):
        build(n).write(Path(__file__).resolve().parent / "mesh" / f"blocks_{n}.msh")
