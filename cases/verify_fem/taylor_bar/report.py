"""Length and foot of the bar at the end, and the largest plastic strain."""
import numpy as np

from undertow_tool.verify.structure import MeasuredStructure

LENGTH = 32.4e-3      # [m] as in mesh.py


def report(results_dir, case, summary):
    run = MeasuredStructure(results_dir, case, summary)
    reference = case["report"]["reference"]
    x, u, strain = run.fields.read(len(run.fields) - 1, "displacement", "plastic_strain")
    start = x - u
    top, foot = np.abs(start[:, 2] - LENGTH) < 1e-7, np.abs(start[:, 2]) < 1e-7
    run.compare("final length", np.mean(x[top, 2]) - np.mean(x[foot, 2]), reference["length"], "m")
    run.compare("radius of the foot", np.max(np.linalg.norm(x[foot, :2], axis=1)), reference["radius"], "m")
    run.tell("largest plastic strain", strain.max())
    energy = run.history("energy.fem")
    run.tell("plastic work over the kinetic energy at the start", energy["plastic"][-1] / energy_at_start(run))
    return run.rows


def energy_at_start(run):
    """[J] of a quarter of the rod, which comes at the wall's speed."""
    material = run.case["fem"]["material"][0]
    return 0.5 * material["density"] * LENGTH * np.pi * 3.2e-3**2 / 4 * run.case["fem"]["motion"][0]["velocity"][2]**2


def draw(axes, runs):
    """Outlines at the end, in the plane y = 0."""
    for label, run in runs:
        x, u = run.fields.read(len(run.fields) - 1, "displacement")
        start = x - u
        at = (np.abs(start[:, 1]) < 1e-9) & (np.abs(start[:, 0] - start[:, 0].max()) < 1e-7)
        order = np.argsort(start[at, 2])
        axes.plot(1e3 * x[at, 0][order], 1e3 * (x[at, 2][order] - x[at, 2].min()), linewidth=1, label=label)
    axes.set(xlabel="radius [mm]", ylabel="z [mm]", aspect="equal", xlim=(0, 8))
    axes.legend(fontsize=7)
