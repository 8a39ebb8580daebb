"""A coarse slide runs at the bucket: it pushes it, in its direction, and nothing is lost."""
import csv
import json

import numpy as np


def history(path):
    rows = [row for row in csv.reader(open(path)) if row and not row[0].startswith("#")]
    return dict(zip(rows[0], np.array(rows[1:], float).T))


def check(results):
    forces = history(results / "forces.csv")
    t, fx = forces["t [s]"], forces["bucket.fx [N]"]
    pushed = fx[(t > 0.6) & (t < 1.1)].mean()
    # the stagnation pressure of water at 3 m/s on the exposed meter, by halves: a few kN
    assert 1e3 < pushed < 3e4, f"mean force {pushed} N on half the bucket"
    parts = forces["bucket.water.fx [N]"] + forces["bucket.slide.fx [N]"]
    assert np.abs(parts - fx).max() < 1e-6 * np.abs(fx).max() + 1e-6, "the fluids' forces are not the whole"

    fem = history(results / "fem.history.csv")
    late = fem["t [s]"] > 0.8
    assert fem["lid.ux [m]"][late].mean() > 1e-4, "the bucket does not give way"
    assert np.abs(fem["lid.ux [m]"]).max() < 0.2, "the bucket is pushed over by a slide that is too coarse to"

    summary = json.loads((results / "summary.sph.json").read_text())["sph"]
    budget = summary["budget"]
    assert budget["closed"] and budget["unaccounted_particles"] == 0, budget
    slide = summary["fluid"]["slide"]
    assert slide["particles_end"] > 0.99 * slide["particles_start"], slide
