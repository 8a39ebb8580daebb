#!/usr/bin/python3
"""Mesh recipe: clay under half of a strip footing, n hexahedra on the half width. Writes mesh/clay_N.msh for N = 4, 8, 16.

Volume set clay; facet sets footing, xmin (the plane of symmetry), xmax, bottom.
"""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from solid_mesh import SolidMesh

HALF, WIDTH, HEIGHT, DEPTH = 1.0, 4.0, 2.0, 0.25       # [m]


def build(n):
    mesh = SolidMesh()

    def block(low, high):
        x, y, z = np.meshgrid(np.linspace(low, high, round(n * (high - low)) + 1), [0, DEPTH],
                              np.linspace(-HEIGHT, 0, round(n * HEIGHT) + 1), indexing="ij")
        nodes = mesh.block("clay", np.stack([x, y, z], axis=-1))
        mesh.face("bottom", nodes[:, :, 0])
        return nodes

    under = block(0, HALF)
    mesh.face("xmin", under[0])
    mesh.face("footing", under[:, :, -1])
    mesh.face("xmax", block(HALF, WIDTH)[-1])
    return mesh


if __name__ == "__main__":
    for n in (4, 8, 16):
        build(n).write(Path(__file__).resolve().parent / "mesh" / f"clay_{n}.msh")
