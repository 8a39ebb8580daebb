"""Water on an implicit plate of 1.6 kg/m2 with friction, for a million steps: nothing grows, nothing leaks."""
import json
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "swinging_plate"))
import check as of_seconds  # noqa: E402
import volume  # noqa: E402


def check(results):
    summary = json.loads((results / "summary.coupler.json").read_text())
    assert summary["steps"] >= 1e6, summary["steps"]
    of_seconds.check(results, first=(30, 40), drift=0.1e-3, off=0.015)
    energy = volume.history(results / "energy.csv")
    t = energy["t [s]"]
    for name in ("sph.kinetic [J]", "fem.kinetic [J]"):
        early, late = (energy[name][(t >= a) & (t < b)] for a, b in ((0, 2), (150, 201)))
        assert np.max(late) < 0.05 * np.max(early), f"{name}: {np.max(early):.3g} J, then {np.max(late):.3g} J"
