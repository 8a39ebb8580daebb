#!/usr/bin/python3
"""Mesh recipe: a quarter of a ring, n hexahedra across the wall. Writes mesh/ring_N.msh for N = 4, 8, 16.

Volume set ring; facet sets inside, xmin and zmin (planes of symmetry).
"""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from solid_mesh import SolidMesh

INNER, OUTER, DEPTH = 1.0, 2.0, 0.25       # [m]


def build(n):
    mesh = SolidMesh()
    # by equal ratios: elements keep their shape
    r, y, angle = np.meshgrid(INNER * (OUTER / INNER)**(np.arange(n + 1) / n), [0, DEPTH],
                              np.linspace(0, np.pi / 2, 2 * n + 1), indexing="ij")
    nodes = mesh.block("ring", np.stack([r * np.cos(angle), y, r * np.sin(angle)], axis=-1))
    mesh.face("inside", nodes[0])
    mesh.face("zmin", nodes[:, :, 0])
    mesh.face("xmin", nodes[:, :, -1])
    return mesh


if __name__ == "__main__":
    for n in (4, 8, 16):
        build(n).write(Path(__file__).resolve().parent / "mesh" / f"ring_{n}.msh")
