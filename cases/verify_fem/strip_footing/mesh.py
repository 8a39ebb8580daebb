#!/usr/bin/python3
"""Mesh recipe: clay under half of a strip footing, n hexahedra on the half width. Writes mesh/clay_N.msh for N = 4, 8, 16, and
mesh/edge.msh, whose elements grow by a tenth each away from the edge, where they are 1/64 of the half width.

Volume set clay; facet sets footing, xmin (the plane of symmetry), xmax, bottom.
"""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from solid_mesh import SolidMesh

HALF, WIDTH, HEIGHT, DEPTH = 1.0, 4.0, 2.0, 0.25       # [m]


def equal(length, n):
    """Places from 0 to length, n to the meter."""
    return np.linspace(0, length, round(n * length) + 1)


def growing(length, n, ratio=1.1):
    """The first 1/n apart, each next interval larger by `ratio`; stretched to end at length."""
    places = (ratio**np.arange(1 + round(np.log1p(n * length * (ratio - 1)) / np.log(ratio))) - 1) / (n * (ratio - 1))
    return places * length / places[-1]


def build(n, places=equal):
    """Nodes at `places` from the edge to both sides and down."""
    mesh = SolidMesh()

    def block(x):
        x, y, z = np.meshgrid(x, [0, DEPTH], 0 - places(HEIGHT, n)[::-1], indexing="ij")
        nodes = mesh.block("clay", np.stack([x, y, z], axis=-1))
        mesh.face("bottom", nodes[:, :, 0])
        return nodes

    under = block(HALF - places(HALF, n)[::-1])
    mesh.face("xmin", under[0])
    mesh.face("footing", under[:, :, -1])
    mesh.face("xmax", block(HALF + places(WIDTH - HALF, n))[-1])
    return mesh


if __name__ == "__main__":
    folder = Path(__file__).resolve().parent / "mesh"
    for n in (4, 8, 16):
        build(n).write(folder / f"clay_{n}.msh")
    build(64, growing).write(folder / "edge.msh")
