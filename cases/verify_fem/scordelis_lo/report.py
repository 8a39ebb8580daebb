"""The sag of the free edge in the middle of the roof, and what still moves."""
import numpy as np

from undertow_tool.verify.structure import MeasuredStructure


def report(results_dir, case, summary):
    run = MeasuredStructure(results_dir, case, summary)
    run.compare("sag of the free edge", -run.mean_of_end("edge.uz"), case["report"]["reference"]["sag"], "m")
    run.residual("still moving", run.unrest("edge.uz"))
    return run.rows


def draw(axes, runs):
    """Midspan of the finest run, magnified."""
    run = runs[-1][1]
    x, u = run.fields.read(len(run.fields) - 1, "displacement")
    at = np.abs((x - u)[:, 0]) < 1e-6
    y, z = (x - u)[at, 1], (x - u)[at, 2]
    order = np.argsort(y)
    scale = 2 / np.abs(u).max()
    axes.plot(y[order], z[order], color="#bbbbbb", linewidth=1, label="before")
    axes.plot((y + scale * u[at, 1])[order], (z + scale * u[at, 2])[order], color="#3b7dd8",
              label=f"midspan, displacement x {scale:.2g}")
    axes.set(xlabel="y [m]", ylabel="z [m]", aspect="equal")
    axes.legend(fontsize=7)
