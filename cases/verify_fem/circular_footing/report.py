"""Mean pressure under a circular footing that gives way, over the strength."""
import numpy as np

from undertow_tool.verify.structure import MeasuredStructure

RADIUS = 1.0      # [m] as in mesh.py
ROUGH, SMOOTH = 6.05, 5.69


def held_radius(run):
    """[m] The outermost nodes bear half an element beyond the edge."""
    x = run.fields.read(0, "displacement")[0]
    beyond = x[(np.abs(x[:, 1]) < 1e-6) & (np.abs(x[:, 2]) < 1e-6) & (x[:, 0] > RADIUS + 1e-6), 0]
    return 0.5 * (RADIUS + beyond.min())


def course(run):
    """(settlement [m], mean pressure over s_u) over time."""
    history = run.history("fem.history")
    area = 0.25 * np.pi * held_radius(run)**2
    strength = run.case["fem"]["material"][0]["shear_strength"]
    return -history["footing.uz"], -history["motion footing.fz"] / (area * strength)


def limit(settlement, load):
    """(load, slope [1/m]) of the straight line through the last half of the course, at no settlement."""
    half = len(load) // 2
    slope, at_first = np.polyfit(settlement[half:], load[half:], 1)
    return float(at_first), float(slope)


def exact(case):
    return ROUGH if any(support["set"] == "footing" for support in case["fem"]["support"]) else SMOOTH


def report(results_dir, case, summary):
    run = MeasuredStructure(results_dir, case, summary)
    load, slope = limit(*course(run))
    run.compare("limit load", load, exact(case))
    run.tell("rise per radius of settlement", slope * RADIUS / load, "1")
    energy = run.history("energy.fem")
    run.tell("hourglass over plastic energy", float(energy["hourglass"][-1] / energy["plastic"][-1]), "1")
    return run.rows


def draw(axes, runs):
    """Load over settlement of all runs."""
    for name, run in runs:
        settlement, load = course(run)
        axes.plot(100 * settlement / RADIUS, load, label=name)
    axes.axhline(ROUGH, color="k", linestyle="--", linewidth=0.7)
    axes.set(xlabel="settlement over radius [%]", ylabel="pressure over s_u")
    axes.legend(fontsize=7)
