#!/usr/bin/python3
"""Mesh recipe: an I-beam of three plates joined along the web's edges. Writes mesh/i_beam_N.msh for N = 20, 40, 80
shells along the beam.

Surface sets web, top, bottom (the plates), end_web, end_top, end_bottom (their last LOADED meters); node set clamp.
"""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from shell_mesh import ShellMesh

LENGTH, HEIGHT, WIDTH, LOADED = 2.0, 0.19, 0.1, 0.1      # [m] between middle planes


def build(n):
    mesh = ShellMesh()
    x = np.linspace(0, LENGTH, n + 1)
    y = np.linspace(-WIDTH / 2, WIDTH / 2, n // 10 + 1)
    z = np.linspace(-HEIGHT / 2, HEIGHT / 2, n // 10 + 1)
    plates = {"web": [[(a, 0.0, c) for c in z] for a in x],
              "top": [[(a, b, HEIGHT / 2) for b in y] for a in x],
              "bottom": [[(a, b, -HEIGHT / 2) for b in y] for a in x]}
    end = int(np.flatnonzero(x > LENGTH - LOADED - 1e-9)[0])
    for name, points in plates.items():
        nodes = mesh.sheet(name, points)
        mesh.sheet(f"end_{name}", points[end:])
        mesh.line("clamp", nodes[0])
    return mesh


if __name__ == "__main__":
    for n in (20, 40, 80):
        build(n).write(Path(__file__).resolve().parent / "mesh" / f"i_beam_{n}.msh")
