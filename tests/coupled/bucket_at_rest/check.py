"""Water over clay, a rigid bed and a bucket, at two particles over the bucket's height: all stays at rest.
The case's own bar, 0.1 mm at 62.5 mm spacing, grows with the force of one particle: dx^2."""
import csv
import json

import numpy as np

LID = 1e-4 * (0.25 / 0.0625) ** 2     # [m]


def history(path):
    rows = [row for row in csv.reader(open(path)) if row and not row[0].startswith("#")]
    return dict(zip(rows[0], np.array(rows[1:], float).T))


def check(results):
    fem = history(results / "fem.history.csv")
    held = fem["t [s]"] < 0.25
    moved = np.hypot(fem["lid.ux [m]"], fem["lid.uz [m]"])
    assert moved[held].max() == 0, f"the lid moved by {moved[held].max()} m while it was held"
    assert 0 < moved.max() < LID, f"the lid moved by {moved.max()} m, allowed {LID} m"
    settle = json.loads((results / "summary.fem.json").read_text())["settle"]
    assert 1e-4 < -settle["bucket"]["uz"] < 2e-3, f"the bucket settled by {settle['bucket']['uz']} m"

    forces = history(results / "forces.csv")
    quiet = forces["t [s]"] > 0.2
    weight = 1000 * 9.81 * 16.5 * 2.5 * 2.0 - 1000 * 9.81 * 0.5 * np.pi / 2 * 1.0   # [N] of the water
    down = -sum(forces[f"{name}.fz [N]"][quiet].mean() for name in ("bucket", "mud_line", "bed"))
    assert abs(down / weight - 1) < 0.03, f"bed and bucket carry {down} N of {weight} N"

    budget = json.loads((results / "summary.sph.json").read_text())["sph"]
    assert budget["removed"] == 0, f"{budget['removed']} particles left"
    residual = json.loads((results / "summary.coupler.json").read_text())["momentum_residual"]
    assert residual < 1e-9, f"momentum residual {residual}"
