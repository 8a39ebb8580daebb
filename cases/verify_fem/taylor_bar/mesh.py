#!/usr/bin/python3
"""Mesh recipe: a quarter of a round bar, n elements on its radius, with a square core. Writes mesh/bar_N.msh for N = 4, 6, 8.

Volume set bar; node sets foot, middle_x, middle_y (planes of symmetry x = 0 and y = 0).
"""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from solid_mesh import SolidMesh

RADIUS, LENGTH, CORE = 3.2e-3, 32.4e-3, 0.6      # [m], share of the radius


def layers(n):
    """[m] finer at the foot: the first cell is a third as long as the last."""
    cells = 3 * n
    size = np.linspace(1, 3, cells)
    return np.concatenate(([0], np.cumsum(size))) / size.sum() * LENGTH


def disc(n):
    """Patches (., ., 2) of a quarter of a disc: a core of m x m with a corner moved in, and two patches of m x (n - m) around it."""
    m = n // 2
    s = np.linspace(0, 1, m + 1)
    corner = CORE * np.sqrt(0.5) * 1.1
    a, b = np.meshgrid(s, s, indexing="ij")
    core = np.stack([a * (CORE + (corner - CORE) * b), b * (CORE + (corner - CORE) * a)], axis=-1) * RADIUS
    patches = [core]
    t = np.linspace(0, 1, n - m + 1)[:, None, None]
    for edge, first in ((core[-1], 0), (core[:, -1], np.pi / 2)):
        angle = np.linspace(first, np.pi / 4, m + 1)
        rim = RADIUS * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        patch = (1 - t) * edge + t * rim
        patches.append(patch if first == 0 else patch.transpose(1, 0, 2))
    return patches


def build(n):
    mesh, z = SolidMesh(), layers(n)
    for patch in disc(n):
        flat = np.repeat(patch[:, :, None, :], len(z), axis=2)
        points = np.concatenate([flat, np.broadcast_to(z[:, None], (*flat.shape[:3], 1))], axis=-1)
        nodes = mesh.block("bar", points)
        mesh.face("foot", nodes[:, :, 0])
        for name, d in (("middle_x", 0), ("middle_y", 1)):
            for side in (nodes[0], nodes[-1], nodes[:, 0], nodes[:, -1]):
                if np.all(np.abs(np.array([mesh.x[k][d] for k in side.ravel()])) < 1e-9):
                    mesh.face(name, side)
    return mesh


if __name__ == "__main__":
    for n in (4, 6, 8):
        build(n).write(Path(__file__).resolve().parent / "mesh" / f"bar_{n}.msh")
