#!/usr/bin/python3
"""Mesh recipe: a quarter of the roof, n x n shells. Writes mesh/roof_N.msh for N = 8, 16, 32.

Surface set roof (normals outward); node sets midspan and crown (planes of symmetry), gable (on its wall).
"""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from shell_mesh import ShellMesh

RADIUS, LENGTH, HALF_ANGLE = 25.0, 50.0, np.radians(40)


def build(n):
    mesh = ShellMesh()
    angle, x = np.linspace(0, HALF_ANGLE, n + 1), np.linspace(0, LENGTH / 2, n + 1)
    points = [[(along, RADIUS * np.sin(a), RADIUS * np.cos(a)) for a in angle] for along in x]
    nodes = mesh.sheet("roof", points)
    mesh.line("midspan", nodes[0])
    mesh.line("gable", nodes[-1])
    mesh.line("crown", nodes[:, 0])
    return mesh


if __name__ == "__main__":
    for n in (8, 16, 32):
        build(n).write(Path(__file__).resolve().parent / "mesh" / f"roof_{n}.msh")
