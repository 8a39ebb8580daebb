"""Cantilever under a sudden pressure: first frequency and mean deflection against beam theory."""
from pathlib import Path

import numpy as np

from undertow_tool import pictures
from undertow_tool.checks import check, relative
from undertow_tool.history import read_history
from undertow_tool.pictures import EXPERIMENT, OURS, plt

ROOT = 1.8751040687119611      # first root of 1 + cos x cosh x
# One or two elements through the depth, and a clamp that does not let the section contract as beam
# theory does: 1 % (tests/unit/fem/beam.test.cpp has the convergence).
TOLERANCE = 0.01
# What the trapezoidal sums of work may leave over in a run of 3e5 steps.
BALANCE_TOLERANCE = 1e-4


class Beam:
    """Euler-Bernoulli with the shear and rotary corrections of Timoshenko, first order."""

    def __init__(self, case):
        box, material = case["fem"]["block"]["box"], case["fem"]["material"][0]
        self.L, _, self.h = (high - low for low, high in zip(box["min"], box["max"]))
        self.E, self.rho, self.nu = (material[key] for key in ("young_modulus", "density", "poisson_ratio"))
        self.p = case["fem"]["pressure"][0]["value"]
        kappa = 10 * (1 + self.nu) / (12 + 11 * self.nu)     # Cowper 1966
        self.kG = kappa * self.E / (2 * (1 + self.nu))

    def deflection(self):
        """Tip under the static pressure [m], downward negative."""
        return -(1.5 * self.p * self.L**4 / (self.E * self.h**3) + self.p * self.L**2 / (2 * self.kG * self.h))

    def frequency(self):
        """[Hz]; Dunkerley's sum of bending and shear, and the rotary inertia of the first mode."""
        bending = ROOT**4 * self.E * self.h**2 / (12 * self.rho * self.L**4)
        shear = (np.pi / (2 * self.L)) ** 2 * self.kG / self.rho
        rotary = 4.648 * (self.h / self.L) ** 2 / 12         # int w'^2 L^2 / int w^2 of the first mode
        return float(np.sqrt(bending / (1 + bending / shear + rotary)) / (2 * np.pi))


def first_mode(t, u, near):
    """Mean and frequency by least squares of c + a cos + b sin (higher modes are orthogonal to it over
    many periods)."""

    def fit(f):
        columns = np.column_stack([np.ones_like(t), np.cos(2 * np.pi * f * t), np.sin(2 * np.pi * f * t)])
        c, rest, *_ = np.linalg.lstsq(columns, u, rcond=None)
        return float(rest[0]), c

    width = 0.2
    f = near
    for _ in range(12):
        trial = np.linspace(f * (1 - width), f * (1 + width), 21)
        f = trial[int(np.argmin([fit(x)[0] for x in trial]))]
        width /= 4
    return float(fit(f)[1][0]), float(f)


def draw(beam, t, u, mean, f, path):
    figure = pictures.new_figure((9, 3.6))
    axes = figure.add_subplot()
    axes.plot(1e3 * t, 1e3 * u, color=OURS, label="Undertow")
    theory = beam.deflection() * (1 - np.cos(2 * np.pi * beam.frequency() * t))
    axes.plot(1e3 * t, 1e3 * theory, "--", color=EXPERIMENT, linewidth=1, label="beam theory, first mode alone")
    axes.axhline(1e3 * beam.deflection(), color="#aaaaaa", linewidth=1)
    axes.set(title=f"Tip of the cantilever: {f:.3f} Hz, mean {1e3 * mean:.4f} mm", xlabel="t [ms]", ylabel="uz [mm]")
    axes.set_ylim(top=0.35 * abs(1e3 * beam.deflection()))
    axes.legend(loc="upper right", ncol=2)
    figure.tight_layout()
    figure.savefig(path)
    plt.close(figure)


def report(results_dir, case, summary):
    folder = Path(results_dir)
    history = read_history(folder / "fem.history.csv")
    if history is None or len(history["t"]) < 100:
        return []
    beam = Beam(case)
    t, u = history["t"], history["tip.uz"]
    mean, f = first_mode(t, u, beam.frequency())
    draw(beam, t, u, mean, f, folder / "report.png")
    rows = [relative("first frequency", f, beam.frequency(), TOLERANCE, "Hz", "Euler-Bernoulli with shear and rotary inertia"),
            relative("mean deflection of the tip, downward", -mean, -beam.deflection(), TOLERANCE, "m", "static, with shear")]
    balance = (summary.get("fem") or {}).get("energy_balance_error")
    if balance is not None:
        rows.append(check("energy balance error", balance, 0.0, balance, BALANCE_TOLERANCE, note="of the peak energy"))
    return rows
