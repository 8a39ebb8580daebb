#!/usr/bin/python3
"""Mesh recipe: a quarter of the clay under a circular footing, n hexahedra on its radius. Writes mesh/clay_N.msh for
N = 4, 8, 12, and mesh/rim.msh with a quarter of the size of clay_6 at the rim, where the stress jumps.

Volume set clay; facet sets footing, xmin and ymin (planes of symmetry), far, bottom. Under the footing a square that a ring
makes round; outside and below elements grow.
"""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from solid_mesh import SolidMesh

RADIUS, FAR, DEPTH = 1.0, 3.0, 2.0       # [m]


def growing(first, length, count):
    """count + 1 places from 0 to length, the first `first` apart, by equal ratios."""
    low, high = 1.0, 3.0
    for _ in range(60):
        ratio = 0.5 * (low + high)
        low, high = (ratio, high) if first * (ratio**count - 1) / (ratio - 1) < length else (low, ratio)
    return length * (ratio**np.arange(count + 1) - 1) / (ratio**count - 1)


def build(n, at_rim=1.0, more=0):
    """Elements at the rim of `at_rim` times the size, `more` of them on each way from it."""
    mesh, m, first = SolidMesh(), n // 2, at_rim / n
    z = -growing(first, DEPTH, round(1.4 * n) + more)[::-1]
    angle = np.linspace(0, np.pi / 2, n + 1)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    # the square's sides bulge halfway toward the circle
    side = np.linspace(0, 0.5, m + 1)
    corner = 0.5 * (0.5 + np.sqrt(0.125))
    s, t = np.meshgrid(side, side, indexing="ij")
    square = np.stack([s * (1 - 4 * (0.5 - corner) * t), t * (1 - 4 * (0.5 - corner) * s)], axis=-1)
    edge = np.concatenate([square[-1, :], square[-2::-1, -1]])

    def block(plane):
        plane = np.asarray(plane)
        points = np.concatenate([np.broadcast_to(plane[:, :, None], (*plane.shape[:2], len(z), 2)),
                                 np.broadcast_to(z[None, None, :, None], (*plane.shape[:2], len(z), 1))], axis=-1)
        nodes = mesh.block("clay", points)
        mesh.face("bottom", nodes[:, :, 0])
        return nodes

    nodes = block(square)
    mesh.face("xmin", nodes[0])
    mesh.face("ymin", nodes[:, 0])
    mesh.face("footing", nodes[:, :, -1])
    shares = np.linspace(0, 1, m + 1) if at_rim == 1 else 1 - growing(2 * first, 1, m + more // 2)[::-1]
    rings = [edge + q * (circle - edge) for q in shares]
    outside = [(RADIUS + r) * circle for r in growing(first, FAR - RADIUS, round(1.4 * n) + more)]
    ring, around = block(rings), block(outside)
    for nodes in (ring, around):
        mesh.face("ymin", nodes[:, 0])
        mesh.face("xmin", nodes[:, -1])
    mesh.face("footing", ring[:, :, -1])
    mesh.face("far", around[-1])
    return mesh


if __name__ == "__main__":
    folder = Path(__file__).resolve().parent / "mesh"
    for n in (4, 8, 12):
        build(n).write(folder / f"clay_{n}.msh")
    build(6, at_rim=0.25, more=6).write(folder / "rim.msh")
