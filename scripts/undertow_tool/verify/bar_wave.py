"""A bar whose end is pressed, against d'Alembert's solution.

The report of every case of a bar from x = 0 to L with xmax fixed in x and a traction on xmin, with or without a ramp, while
the wave that the fixed end returned has not come back.
"""
import numpy as np

from .structure import MeasuredStructure


class PressedBar:
    """Stress and velocity of sigma = -p g(t) at x = 0, fixed at L, t < 2 L/c:
    sigma = -p [g(t - x/c) + g(t - (2L - x)/c)],   v = p/(rho c) [g(t - x/c) - g(t - (2L - x)/c)]   [d'Alembert 1747]
    """
    def __init__(self, case):
        fem = case["fem"]
        material, load = fem["material"][0], fem["traction"][0]
        self.length = fem["block"]["box"]["max"][0]
        self.c = float(np.sqrt(material["young_modulus"] / material["density"]))      # [m/s]
        self.pressure, self.ramp = load["value"][0], load["ramp"]                      # [Pa], [s]
        self.speed = self.pressure / (material["density"] * self.c)                   # [m/s] of the loaded end
        self.area = float(np.prod(np.subtract(fem["block"]["box"]["max"], fem["block"]["box"]["min"])[1:]))

    def load(self, t):
        if self.ramp == 0:
            return np.where(t >= 0, 1.0, 0.0)
        s = np.clip(t / self.ramp, 0, 1)
        return s * s * (3 - 2 * s)

    def stress(self, x, t):
        return -self.pressure * (self.load(t - x / self.c) + self.load(t - (2 * self.length - x) / self.c))

    def velocity(self, x, t):
        return self.speed * (self.load(t - x / self.c) - self.load(t - (2 * self.length - x) / self.c))


def crossing(t, values, level):
    """First time at which values reach the level, by the straight line between rows."""
    k = int(np.argmax(values >= level))
    return float(t[k - 1] + (level - values[k - 1]) / (values[k] - values[k - 1]) * (t[k] - t[k - 1]))


def centers(run):
    """[m] x of the elements' centers in the undeformed mesh."""
    n = run.case["fem"]["block"]["divisions"][0]
    return (np.arange(n) + 0.5) / n * PressedBar(run.case).length


def report(results_dir, case, summary):
    run, bar = MeasuredStructure(results_dir, case, summary), PressedBar(case)
    x = centers(run)
    for step, name in ((1, "before the reflection"), (2, "after the reflection")):
        found = run.fields.read(step, "stress")[1][:, 0]
        wanted = bar.stress(x, run.times[step])
        run.residual(f"stress, L2, {name}", np.sqrt(np.sum((found - wanted)**2) / np.sum(wanted**2)))
    t, reaction = run.probe("support xmax.rx")
    run.compare("arrival at the fixed end", crossing(t, -reaction, bar.pressure * bar.area),
                bar.length / bar.c + 0.5 * bar.ramp, "s")
    late = t > bar.length / bar.c + max(1.1 * bar.ramp, 0.2 * bar.length / bar.c)
    run.compare("plateau at the fixed end", np.mean(-reaction[late]), 2 * bar.pressure * bar.area, "N")
    run.residual("overshoot", np.max(-reaction) / (2 * bar.pressure * bar.area) - 1)
    t, v = run.probe("end.vx")
    late = t > bar.ramp + 0.2 * bar.length / bar.c
    run.compare("speed of the loaded end", np.mean(v[late]), bar.speed, "m/s")
    return run.rows


def draw(axes, runs):
    """Stress along the bar after the reflection."""
    for label, run in runs:
        axes.plot(centers(run), -run.fields.read(2, "stress")[1][:, 0] / 1e6, linewidth=1, label=label)
    run = runs[-1][1]
    x = np.linspace(0, PressedBar(run.case).length, 1001)
    axes.plot(x, -PressedBar(run.case).stress(x, run.times[2]) / 1e6, "k--", linewidth=0.8, label="exact")
    axes.set(xlabel="x [m]", ylabel="pressure [MPa]")
    axes.legend(fontsize=7)
