"""Friction on three walls, against its integral over the depth, and what still moves."""
import numpy as np

from undertow_tool.verify.structure import MeasuredStructure

DEPTH, LANE = 1.0, 0.25      # [m] as in mesh.py


def integral(run, contact):
    """[N] of both sides."""
    z = (np.arange(4000) + 0.5) / 4000 * DEPTH
    pressure = -run.gravity[2] * run.case["fem"]["material"][0]["weight_density"] * z * run.case["fem"]["geostatic"]["earth_pressure"]
    shear = contact["friction"] * pressure
    if contact["max_shear"]:
        shear = np.minimum(shear, contact["max_shear"])
    return float(2 * np.mean(shear) * DEPTH * LANE)


def report(results_dir, case, summary):
    run = MeasuredStructure(results_dir, case, summary)
    for contact in case["fem"]["contact"]:
        run.compare(f"pull, {contact['name']}", run.mean_of_end(f"{contact['name']}.tz"), integral(run, contact), "N")
    run.residual("still moving", max(run.unrest(f"{contact['name']}.tz") for contact in case["fem"]["contact"]))
    return run.rows


def draw(axes, runs):
    """Pull over displacement of the finest run."""
    run = runs[-1][1]
    u = run.probe("motion pull.uz")[1]
    for contact, color in zip(run.case["fem"]["contact"], ("#3b7dd8", "#d1495b", "#2a9d8f")):
        axes.plot(1e3 * u, run.probe(f"{contact['name']}.tz")[1], color=color, linewidth=1, label=contact["name"])
        axes.axhline(integral(run, contact), color=color, linestyle="--", linewidth=0.7)
    axes.set(xlabel="pulled by [mm]", ylabel="friction [N]")
    axes.legend(fontsize=7)
