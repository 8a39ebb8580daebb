"""Collapse pressure of a thick tube and the radial stress in it."""
import numpy as np

from undertow_tool.verify.structure import MeasuredStructure

INNER, OUTER = 1.0, 2.0      # [m] as in mesh.py


def radial_stress(run):
    """(radius [m], radial stress [Pa]) at the elements' centers at the end."""
    x, stress = run.fields.read(len(run.fields) - 1, "stress")
    center = x[run.fields.hexahedra].mean(axis=1)
    r = np.hypot(center[:, 0], center[:, 2])
    c, s = center[:, 0] / r, center[:, 2] / r
    return r, c**2 * stress[:, 0] + s**2 * stress[:, 2] + 2 * c * s * stress[:, 5]


def end_of(run):
    """(speed of the inside [m/s], radii [m]) at the end."""
    t, u = run.probe("inside.ux")
    end = t > 0.8 * t[-1]
    v = float(np.polyfit(t[end], u[end], 1)[0])
    return v, INNER + u[-1], OUTER + run.probe("outside.ux")[1][-1]


def report(results_dir, case, summary):
    run = MeasuredStructure(results_dir, case, summary)
    clay, fem = case["fem"]["material"][0], case["fem"]
    v, a, b = end_of(run)
    pressure, wall = fem["pressure"][0]["value"], float(np.log(b / a))
    run.compare("collapse pressure", pressure - fem["damping_alpha"] * clay["density"] * v * a * wall,
                2 * clay["shear_strength"] * wall, "Pa")
    # damping grows inward as 1/r, as the strength's share does: what is over makes the profile steeper, no other
    r, stress = radial_stress(run)
    exact = -pressure * np.log(b / r) / wall
    run.residual("radial stress, L2", float(np.sqrt(np.sum((stress - exact)**2) / np.sum(exact**2))))
    run.tell("speed of the inside", v, "m/s")
    return run.rows


def draw(axes, runs):
    """Radial stress of the elements of all runs."""
    for name, run in runs:
        r, stress = radial_stress(run)
        axes.plot(r, 1e-3 * stress, ".", markersize=3, label=name)
    r = np.linspace(INNER, OUTER, 100)
    p = runs[-1][1].case["fem"]["pressure"][0]["value"]
    axes.plot(r, -1e-3 * p * np.log(OUTER / r) / np.log(OUTER / INNER), "k--", linewidth=0.7)
    axes.set(xlabel="r [m]", ylabel="radial stress [kPa]")
    axes.legend(fontsize=7)
