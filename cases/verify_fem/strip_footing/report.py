"""Mean pressure under a strip footing that gives way, over the strength."""
import numpy as np

from undertow_tool.verify.structure import MeasuredStructure

HALF, DEPTH = 1.0, 0.25      # [m] as in mesh.py


def course(run):
    """(settlement [m], mean pressure over s_u) over time. The outermost nodes bear half an element beyond the edge."""
    history = run.history("fem.history")
    width = HALF + 0.5 * run.dx
    strength = run.case["fem"]["material"][0]["shear_strength"]
    return -history["footing.uz"], -history["motion footing.fz"] / (width * DEPTH * strength)


def report(results_dir, case, summary):
    run = MeasuredStructure(results_dir, case, summary)
    settlement, load = course(run)
    run.compare("limit load", float(np.mean(load[-20:])), 2 + np.pi)
    half = len(load) // 2
    run.tell("rise over the last half", float(load[-1] / load[half] - 1), "1")
    return run.rows


def draw(axes, runs):
    """Load over settlement of all runs."""
    for name, run in runs:
        settlement, load = course(run)
        axes.plot(100 * settlement / HALF, load, label=name)
    axes.axhline(2 + np.pi, color="k", linestyle="--", linewidth=0.7)
    axes.set(xlabel="settlement over half width [%]", ylabel="pressure over s_u")
    axes.legend(fontsize=7)
