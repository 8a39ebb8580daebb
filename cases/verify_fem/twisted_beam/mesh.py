#!/usr/bin/python3
"""Mesh recipe: two flat beams beside each other, each twisted by 90 degrees, n shells along and n/6 across. Writes
mesh/beams_N.msh for N = 12, 24, 48.

Surface set beams; node sets root (of both), tip_in (loaded along its width), tip_out (loaded across it).
"""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from shell_mesh import ShellMesh

LENGTH, WIDTH, APART = 12.0, 1.1, 3.0


def build(n):
    mesh = ShellMesh()
    x, s = np.linspace(0, LENGTH, n + 1), np.linspace(-WIDTH / 2, WIDTH / 2, n // 6 + 1)
    for name, y in (("tip_in", 0.0), ("tip_out", APART)):
        # across along y at the root, along z at the tip
        turn = 0.5 * np.pi * x / LENGTH
        points = [[(along, y + b * np.cos(a), b * np.sin(a)) for b in s] for along, a in zip(x, turn)]
        nodes = mesh.sheet("beams", points)
        mesh.line("root", nodes[0])
        mesh.line(name, nodes[-1])
    return mesh


if __name__ == "__main__":
    for n in (12, 24, 48):
        build(n).write(Path(__file__).resolve().parent / "mesh" / f"beams_{n}.msh")
