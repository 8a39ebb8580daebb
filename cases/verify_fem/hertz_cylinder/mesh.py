#!/usr/bin/python3
"""Mesh recipe: half of a block, finest under the lowest line of a rigid cylinder above it. Writes mesh/hertz_N.msh for N = 4, 8,
16 elements on the expected half width of the contact.

Volume sets block, cylinder; facet sets top, foot (of the cylinder); node sets middle (plane of symmetry), bottom.
"""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from solid_mesh import SolidMesh

RADIUS, HALF_WIDTH, SIZE, THICKNESS, GAP = 1.0, 0.01, 0.5, 0.01, 2e-7      # [m]


def graded(h, even):
    """0 to SIZE: cells of h up to `even`, then growing by a fifth, the last ones stretched to end at SIZE."""
    x = list(np.arange(0, even + 0.5 * h, h))
    steps = []
    while x[-1] + sum(steps) < SIZE:
        steps.append(h * 1.2 ** (len(steps) + 1))
    stretch = (SIZE - x[-1]) / sum(steps)
    return np.array(x + list(x[-1] + stretch * np.cumsum(steps)))


def build(n):
    mesh, h = SolidMesh(), HALF_WIDTH / n
    across, down = graded(h, 1.5 * HALF_WIDTH), -graded(h, HALF_WIDTH)[::-1]
    nodes = mesh.block("block", np.stack(np.meshgrid(across, [0, THICKNESS], down, indexing="ij"), axis=-1))
    mesh.face("top", nodes[:, :, -1])
    mesh.face("middle", nodes[0])
    mesh.face("bottom", nodes[:, :, 0])
    x = np.linspace(-3, 3, 25) * HALF_WIDTH
    foot = RADIUS - np.sqrt(RADIUS**2 - x**2) + GAP
    foot -= foot.min() - GAP
    points = [[[(a, y, b) for b in (low, 0.01)] for y in (-THICKNESS, 2 * THICKNESS)] for a, low in zip(x, foot)]
    cylinder = mesh.block("cylinder", np.array(points))
    mesh.face("foot", cylinder[:, :, 0])
    return mesh


if __name__ == "__main__":
    for n in (4, 8, 16):
        build(n).write(Path(__file__).resolve().parent / "mesh" / f"hertz_{n}.msh")
