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


def limit(settlement, load):
    """(load, slope [1/m]) of the straight line through the last half of the course, at no settlement."""
    half = len(load) // 2
    slope, at_first = np.polyfit(settlement[half:], load[half:], 1)
    return float(at_first), float(slope)


def report(results_dir, case, summary):
    run = MeasuredStructure(results_dir, case, summary)
    load, slope = limit(*course(run))
    run.compare("limit load", load, 2 + np.pi)
    run.tell("rise per half width of settlement", slope * HALF / load, "1")
    return run.rows


def draw(axes, runs):
    """Load over settlement of all runs."""
    for name, run in runs:
        settlement, load = course(run)
        axes.plot(100 * settlement / HALF, load, label=name)
    axes.axhline(2 + np.pi, color="k", linestyle="--", linewidth=0.7)
    axes.set(xlabel="settlement over half width [%]", ylabel="pressure over s_u")
    axes.legend(fontsize=7)
