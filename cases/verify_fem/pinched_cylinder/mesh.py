#!/usr/bin/python3
"""Mesh recipe: an eighth of the cylinder, n x n shells. Writes mesh/cylinder_N.msh for N = 8, 16, 32.

Surface set cylinder (normals outward); node sets diaphragm (its end), midspan, top and side (planes of symmetry), load (the
node under the load).
"""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from shell_mesh import ShellMesh

RADIUS, LENGTH = 300.0, 600.0


def build(n):
    mesh = ShellMesh()
    angle, x = np.linspace(0, np.pi / 2, n + 1), np.linspace(0, LENGTH / 2, n + 1)
    points = [[(along, RADIUS * np.sin(a), RADIUS * np.cos(a)) for a in angle] for along in x]
    nodes = mesh.sheet("cylinder", points)
    mesh.line("diaphragm", nodes[0])
    mesh.line("midspan", nodes[-1])
    mesh.line("top", nodes[:, 0])
    mesh.line("side", nodes[:, -1])
    mesh.point("load", nodes[-1, 0])
    return mesh


if __name__ == "__main__":
    for n in (8, 16, 32):
        build(n).write(Path(__file__).resolve().parent / "mesh" / f"cylinder_{n}.msh")
