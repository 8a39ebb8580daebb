"""Mean pressure under a strip footing on clay whose strength grows with depth, over the strength under it."""
import numpy as np

from undertow_tool.verify import slip_lines
from undertow_tool.verify.structure import MeasuredStructure

HALF, DEPTH = 1.0, 0.25      # [m] as in ../strip_footing/mesh.py


def held_half(run):
    """[m] The outermost nodes bear half an element beyond the edge."""
    x = run.fields.read(0, "displacement")[0]
    return 0.5 * (HALF + x[(x[:, 2] > -1e-6) & (x[:, 0] > HALF + 1e-6), 0].min())


def course(run):
    """(settlement [m], mean pressure over the strength under the footing) over time."""
    history = run.history("fem.history")
    strength = run.case["fem"]["material"][0]["shear_strength"]
    return -history["footing.uz"], -history["motion footing.fz"] / (held_half(run) * DEPTH * strength)


def exact(run):
    clay = run.case["fem"]["material"][0]
    rough = any(support["set"] == "footing" for support in run.case["fem"]["support"])
    ratio = clay["strength_gradient"] * 2 * held_half(run) / clay["shear_strength"]
    return slip_lines.converged(slip_lines.rough_load if rough else slip_lines.smooth_load, ratio)[0]


def error_of_strength(run):
    """Of the field, against s_0 + k z at the elements' centers."""
    x, strength = run.fields.read(0, "strength")
    clay = run.case["fem"]["material"][0]
    depth = clay["strength_level"] - x[run.fields.hexahedra].mean(axis=1)[:, 2]
    exact = clay["shear_strength"] + clay["strength_gradient"] * depth
    return float(np.sqrt(np.sum((strength - exact)**2) / np.sum(exact**2)))


def report(results_dir, case, summary):
    run = MeasuredStructure(results_dir, case, summary)
    settlement, load = course(run)
    half = len(load) // 2
    slope, at_first = np.polyfit(settlement[half:], load[half:], 1)
    run.compare("limit load", float(at_first), exact(run))
    run.tell("rise per half width of settlement", float(slope * HALF / at_first), "1")
    energy = run.history("energy.fem")
    run.tell("hourglass over plastic energy", float(energy["hourglass"][-1] / energy["plastic"][-1]), "1")
    run.residual("strength of the elements, L2", error_of_strength(run))
    return run.rows


def draw(axes, runs):
    """Load over settlement of all runs."""
    for name, run in runs:
        settlement, load = course(run)
        line, = axes.plot(100 * settlement / HALF, load, label=name)
        axes.axhline(exact(run), color=line.get_color(), linestyle="--", linewidth=0.7)
    axes.set(xlabel="settlement over half width [%]", ylabel="pressure over s_u under the footing")
    axes.legend(fontsize=7)
