#!/usr/bin/python3
"""Mesh recipe: a quarter of a round block, finest under the lowest point of a rigid sphere above it. Writes mesh/hertz_N.msh for
N = 4, 6, 9 elements on the expected radius of the contact.

Volume sets block, sphere; facet sets top, foot (of the sphere); node sets middle_x, middle_y (planes of symmetry), bottom.
"""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from solid_mesh import SolidMesh

RADIUS, CONTACT, SIZE, GAP = 1.0, 0.01, 0.3, 2e-7      # [m]
CORE, FINE = 0.75, 1.5                                 # of the contact's radius: half of the square core, and the uniform part
ROUNDING = 0.5                                         # of the core's edge, from square to circle


def graded(h, start, growth):
    """start to SIZE: cells that grow from h on, stretched to end at SIZE."""
    steps = []
    while start + sum(steps) < SIZE:
        steps.append(h * growth ** (len(steps) + 1))
    return start + np.cumsum(steps) * (SIZE - start) / sum(steps)


def core(m):
    """(m + 1, m + 1, 2): a square whose edge bends outward."""
    i, j = np.meshgrid(np.arange(m + 1), np.arange(m + 1), indexing="ij")
    far = np.maximum(np.maximum(i, j), 1) / m
    cosine = np.maximum(i, j) / np.maximum(np.hypot(i, j), 1)
    factor = np.where(np.maximum(i, j) > 0, 1 - ROUNDING * far + ROUNDING * far * cosine, 1)
    return CORE * CONTACT / m * factor[..., None] * np.stack([i, j], axis=-1)


def rings(edge, angles, radii, m):
    """(radial + 1, m + 1, 2): from the core's edge through FINE contact radii to SIZE."""
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    inner = FINE * CONTACT * circle
    near = [edge + (inner - edge) * s for s in np.linspace(0, 1, m + 1)]
    return np.array(near + [r * circle for r in radii])


def build(n):
    mesh, h, m = SolidMesh(), CONTACT / n, round(CORE * n)
    z = -np.concatenate([np.arange(0, CONTACT + 0.5 * h, h), graded(h, CONTACT, 1.3)])[::-1]
    radii = graded(h, FINE * CONTACT, 1.3)
    square = core(m)
    eighth = np.pi / 4 * np.arange(m + 1) / m
    plans = {
        "core": square,
        "low": rings(square[-1], eighth, radii, m),
        "high": rings(square[::-1, -1], np.pi / 4 + eighth, radii, m),
    }
    for name, plan in plans.items():
        points = np.concatenate([np.broadcast_to(plan[:, :, None], (*plan.shape[:2], len(z), 2)),
                                 np.broadcast_to(z[:, None], (*plan.shape[:2], len(z), 1))], axis=-1)
        nodes = mesh.block("block", points)
        mesh.face("top", nodes[:, :, -1])
        mesh.face("bottom", nodes[:, :, 0])
        if name != "high":
            mesh.face("middle_y", nodes[:, 0])
        if name == "core":
            mesh.face("middle_x", nodes[0])
        if name == "high":
            mesh.face("middle_x", nodes[:, -1])
    x = np.linspace(-2.5, 2.5, 21) * CONTACT
    foot = [[[(a, b, RADIUS - np.sqrt(RADIUS**2 - a**2 - b**2) + GAP), (a, b, 0.01)] for b in x] for a in x]
    sphere = mesh.block("sphere", np.array(foot))
    mesh.face("foot", sphere[:, :, 0])
    return mesh


if __name__ == "__main__":
    for n in (4, 6, 9):
        build(n).write(Path(__file__).resolve().parent / "mesh" / f"hertz_{n}.msh")
