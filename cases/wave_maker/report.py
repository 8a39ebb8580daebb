"""A wave maker against linear theory: height and length of its waves, and the power it gives them.

Everything is the harmonic of the wave maker's own period, fitted over a whole number of periods; what is of second
order in the steepness (k a = 0.11) lies in the other harmonics.
"""
from pathlib import Path

import numpy as np

from undertow_tool import pictures
from undertow_tool.fields import open_fields
from undertow_tool.history import read_history
from undertow_tool.pictures import EXPERIMENT, OURS, WATER, plt
from undertow_tool.verify.measured import Measured

GAUGES = {"level_1.5m": 1.5, "level_2m": 2.0, "level_2.5m": 2.5}      # [m] from the wave maker at rest


class LinearTheory:
    """Waves of period T on water of depth h [Biesel, Suquet 1951; Dean, Dalrymple 1991, Eqs. 6.25, 6.26]."""

    def __init__(self, depth, period, gravity):
        self.depth, self.gravity, self.omega = depth, gravity, 2 * np.pi / period
        k = self.omega**2 / gravity
        for _ in range(100):              # omega^2 = g k tanh(k h), by Newton
            tanh = np.tanh(k * depth)
            k -= (gravity * k * tanh - self.omega**2) / (gravity * (tanh + k * depth * (1 - tanh**2)))
        self.k = k

    def transfer(self, flap):
        """Wave height over stroke, far from the wave maker."""
        kh = self.k * self.depth
        if flap:
            return 4 * np.sinh(kh) / kh * (kh * np.sinh(kh) - np.cosh(kh) + 1) / (np.sinh(2 * kh) + 2 * kh)
        return 2 * (np.cosh(2 * kh) - 1) / (np.sinh(2 * kh) + 2 * kh)

    def group_speed(self):
        kh = self.k * self.depth
        return 0.5 * self.omega / self.k * (1 + 2 * kh / np.sinh(2 * kh))

    def power(self, height, density):
        """Mean flux of energy of waves of this height [W/m]."""
        return density * self.gravity * height**2 / 8 * self.group_speed()


def harmonic(t, values, omega, span):
    """Complex amplitude of cos(omega t) over the span, beside a mean and the next two harmonics."""
    inside = (t >= span[0] - 1e-9) & (t <= span[1] + 1e-9)
    columns = [np.ones(inside.sum())]
    for n in (1, 2, 3):
        columns += [np.cos(n * omega * t[inside]), np.sin(n * omega * t[inside])]
    found = np.linalg.lstsq(np.column_stack(columns), values[inside], rcond=None)[0]
    return found[1] - 1j * found[2]


class Run(Measured):
    def __init__(self, folder, case, summary):
        # a plain run is judged as the standard level is, where nothing else was changed
        super().__init__(folder, case, {**summary, "level": summary.get("level") or "standard"})
        of = case["report"]
        self.theory = LinearTheory(of["depth"], of["period"], -self.gravity[2])
        self.span, self.stroke = of["span"], of["stroke"]
        self.flap = bool(case["sph"]["body"][0].get("angle"))
        self.density = case["sph"]["fluid"][0]["density"]
        self.levels = self.history("gauges")
        every = next(g["every"] for g in case["sph"]["gauge"] if g["kind"] == "force")
        self.force = read_history(self.folder / f"gauges.every_{every:g}s.csv")

    @property
    def wave_height(self):
        return self.theory.transfer(self.flap) * self.stroke

    def of(self, gauge):
        return harmonic(self.levels["t"], self.levels[gauge], self.theory.omega, self.span)

    def wave_number(self):
        """From the phases at three gauges, which fall by k per meter [1/m]."""
        x = np.array(list(GAUGES.values()))
        phase = np.unwrap([np.angle(self.of(name)) for name in GAUGES])
        return -np.polyfit(x, phase, 1)[0]

    def power(self):
        """Mean of -F v of a piston over the span, per width [W/m]."""
        t, force = self.force["t"], self.force["on_piston.fx"] / self.case["case"]["thickness"]
        omega = self.theory.omega
        speed = 0.5 * self.stroke * omega * np.cos(omega * t)
        inside = (t > self.span[0]) & (t <= self.span[1])
        return -np.mean((force * speed)[inside])


def report(results_dir, case, summary):
    run = Run(Path(results_dir), case, summary)
    if run.levels["t"][-1] < run.span[1] - 0.05:
        return []                          # a shorter run has no whole number of periods
    height = run.wave_height
    for name, x in GAUGES.items():
        run.compare(f"wave height at {x:g} m, first harmonic", 2 * abs(run.of(name)), height, "m")
    inside = (run.levels["t"] >= run.span[0]) & (run.levels["t"] <= run.span[1])
    level = run.levels["level_2m"][inside]
    run.compare("wave height at 2 m, highest crest less lowest trough", level.max() - level.min(), height, "m")
    run.compare("wave length", 2 * np.pi / run.wave_number(), 2 * np.pi / run.theory.k, "m")
    if not run.flap:
        run.compare("power of the wave maker", run.power(), run.theory.power(height, run.density), "W/m")
    cost = summary.get("cost") or {}
    run.tell("CPU time", cost.get("cpu_s", summary.get("wall_s", 0) * summary.get("threads", 1)), "s",
             "" if cost else "wall clock times threads")
    picture(run, run.folder / "report.png")
    return run.rows


def draw(axes, runs):
    for label, run in runs:
        levels = run.history("gauges")
        axes.plot(levels["t"], 100 * (levels["level_2m"] - run.settings["depth"]), linewidth=0.8, label=label)
    theory = Run(run.folder, run.case, run.summary)
    axes.axhline(50 * theory.wave_height, color="k", linestyle="--", linewidth=0.7)
    axes.axhline(-50 * theory.wave_height, color="k", linestyle="--", linewidth=0.7, label="linear theory")
    axes.set(xlabel="t [s]", ylabel="level at 2 m [cm]")
    axes.legend(fontsize=7)


def picture(run, path):
    figure = pictures.new_figure((10, 6))
    water, level, work = figure.subplots(3, 1)
    fields = open_fields(run.folder / "sph.vtkhdf")
    x, p = fields.read(len(fields) - 1, "pressure")
    water.scatter(x[:, 0], x[:, 2], c=p, s=0.8, cmap="viridis")
    water.set(title=f"{run.case['case']['title']}, {fields.times[-1]:.1f} s, dx = {1000 * run.dx:g} mm", ylabel="z [m]", xlim=(-0.2, 6.2))
    water.grid(False)
    amplitude = 50 * run.wave_height
    level.plot(run.levels["t"], 100 * (run.levels["level_2m"] - run.settings["depth"]), color=WATER, label="2 m from the piston")
    level.plot(run.span, [amplitude] * 2, "--", color=EXPERIMENT, label="linear theory")
    level.plot(run.span, [-amplitude] * 2, "--", color=EXPERIMENT)
    level.set(ylabel="level [cm]", xlim=(0, run.levels["t"][-1]))
    level.legend(loc="lower left")
    work.plot(run.force["t"], run.force["on_piston.fx"], color=OURS, linewidth=0.8)
    work.set(xlabel="t [s]", ylabel="force on the wave maker [N]", xlim=(0, run.levels["t"][-1]))
    figure.tight_layout()
    figure.savefig(path, dpi=100)
    plt.close(figure)
