#!/usr/bin/python3
"""Mesh recipe: a thin plate of shells that stands on clay. Writes plate.msh.

Volume set clay; facet sets top, bottom, sides; shells plate, 5 mm (half of its thickness) and a gap of 5 mm above.
"""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "cases" / "verify_fem"))
from solid_mesh import SolidMesh

mesh = SolidMesh()
clay = mesh.box("clay", (-0.5, -0.5, -0.6), (0.5, 0.5, 0), (5, 5, 4))
mesh.face("top", clay[:, :, -1])
mesh.face("bottom", clay[:, :, 0])
for side in (clay[0], clay[-1], clay[:, 0], clay[:, -1]):
    mesh.face("sides", side)
x, y = np.meshgrid(np.linspace(-0.25, 0.25, 4), np.linspace(-0.3, 0.2, 4), indexing="ij")
mesh.sheet("plate", np.stack([x, y, np.full_like(x, 0.01)], axis=-1))
mesh.write(Path(__file__).resolve().parent / "plate.msh")
