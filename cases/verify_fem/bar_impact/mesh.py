#!/usr/bin/python3
"""Mesh recipe: a wall, before it a bar in one piece and a bar in two, of n elements each. Writes mesh/bars_N.msh for N = 50,
100, 200.

Volume sets wall, bar, halves; facet sets wall_face, bar_foot, lower_foot, lower_end, upper_foot.
"""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from solid_mesh import SolidMesh

LENGTH, SIDE, APART, GAP = 1.0, 0.02, 0.04, 1e-4      # [m]


def build(n):
    mesh = SolidMesh()
    wall = mesh.box("wall", (-SIDE - GAP, -SIDE, -SIDE), (-GAP, APART + 2 * SIDE, 2 * SIDE), (1, 1, 1))
    mesh.face("wall_face", wall[-1])
    bar = mesh.box("bar", (0, 0, 0), (LENGTH, SIDE, SIDE), (n, 1, 1))
    mesh.face("bar_foot", bar[0])
    lower = mesh.box("halves", (0, APART, 0), (LENGTH / 2, APART + SIDE, SIDE), (n // 2, 1, 1))
    mesh.face("lower_foot", lower[0])
    mesh.face("lower_end", lower[-1])
    upper = mesh.box("halves", (LENGTH / 2 + GAP, APART, 0), (LENGTH + GAP, APART + SIDE, SIDE), (n // 2, 1, 1))
    mesh.face("upper_foot", upper[0])
    return mesh


if __name__ == "__main__":
    for n in (50, 100, 200):
        build(n).write(Path(__file__).resolve().parent / "mesh" / f"bars_{n}.msh")
