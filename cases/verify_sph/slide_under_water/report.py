"""A slide under water: the budgets of momentum, energy and volume, and how far it gets."""
import numpy as np

from undertow_tool.verify.measured import Measured


def slide_front(run, step):
    """Foremost point of the slide: mean of its ten foremost particles [m]."""
    x, = run.fields.read(step)
    mine = np.sort(x[run.fluid_of(step, len(x)) == 1, 0])
    return float(np.mean(mine[-10:]))


def report(results_dir, case, summary):
    run = Measured(results_dir, case, summary)
    run.residual("momentum, not accounted for", run.momentum_error())
    energy = run.history("energy.sph")
    total = energy["kinetic"] + energy["potential"] + energy["elastic"]
    released = energy["potential"][0] - energy["potential"].min()
    run.residual("energy, largest rise over what gravity released", np.max(total - np.minimum.accumulate(total)) / released)
    run.tell("energy dissipated over what gravity released", float((total[0] - total[-1]) / released))
    last = len(run.fields) - 1
    x, = run.fields.read(last)
    volume, start = (float(np.sum(run.masses(k, len(x)) / run.fields.read(k, "density")[1])) for k in (last, 0))
    run.residual("volume of all particles, change", volume / start - 1)
    run.tell("front of the slide at the end", slide_front(run, last), "m")
    return run.rows


def draw(axes, runs):
    label, run = runs[-1]
    for k, t in enumerate((0.5, 1.0, 1.5)):
        step = run.fields.nearest(t)
        x, = run.fields.read(step)
        slide = run.fluid_of(step, len(x)) == 1
        axes.plot(x[slide, 0], x[slide, 2] - 1.3 * k, ".", color="#b5793a", markersize=0.8)
        axes.plot([0, 4, 4, 0, 0], np.array([0, 0, 1, 1, 0]) - 1.3 * k, color="#888888", linewidth=0.7)
        axes.text(0.1, 0.8 - 1.3 * k, f"{t:g} s, {label}", fontsize=7)
    axes.set(aspect="equal", xlabel="x [m]", yticks=[])
    axes.grid(False)
