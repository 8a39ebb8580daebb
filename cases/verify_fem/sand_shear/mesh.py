#!/usr/bin/python3
"""Mesh recipe: a layer of sand under a cap. Writes mesh/layer_N.msh for N = 1, 2, 4 hexahedra along the layer.

Volume sets sand, cap; facet sets bottom, top.
"""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from solid_mesh import SolidMesh

LENGTH, DEPTH, HEIGHT, CAP = 1.0, 0.25, 0.25, 0.1      # [m]


def build(n):
    mesh = SolidMesh()

    def layer(low, high):
        x, y, z = np.meshgrid(np.linspace(0, LENGTH, n + 1), [0, DEPTH], [low, high], indexing="ij")
        return np.stack([x, y, z], axis=-1)

    mesh.face("bottom", mesh.block("sand", layer(0, HEIGHT))[:, :, 0])
    mesh.face("top", mesh.block("cap", layer(HEIGHT, HEIGHT + CAP))[:, :, -1])
    return mesh


if __name__ == "__main__":
    for n in (1, 2, 4):
        build(n).write(Path(__file__).resolve().parent / "mesh" / f"layer_{n}.msh")
