"""Front and height of a collapsing column against Martin and Moyce 1952."""
from pathlib import Path

import numpy as np

from undertow_tool.verify.measured import Measured

REFERENCE = Path(__file__).parent / "reference"
SHIFTS = np.linspace(-0.5, 0.5, 201)      # of T


def experiment(quantity, ratio):
    rows = [line.split(",") for line in (REFERENCE / f"martin_moyce1952_{quantity}.csv").read_text().splitlines()
            if line.startswith(f"n2={ratio},")]
    return np.array([[float(cell) for cell in row[1:]] for row in rows]).T


def curves(run):
    """(height/width, T, Z, tau, H) as the experiment has them."""
    box = run.case["sph"]["fill"][0]["box"]
    a, height = box["max"][0], box["max"][2]
    gauges = run.history("gauges")
    tau = gauges["t"] * np.sqrt(-run.gravity[2] / a)
    ratio = round(height / a)
    return ratio, tau * np.sqrt(ratio), gauges["front"] / a, tau, gauges["height"] / height


def report(results_dir, case, summary):
    run = Measured(results_dir, case, summary)
    ratio, T, Z, tau, H = curves(run)
    time, front = experiment("front", ratio)
    used = time < T[-1] - SHIFTS[-1]
    rms = [np.sqrt(np.mean((np.interp(time[used] + s, T, Z) - front[used]) ** 2)) for s in SHIFTS]
    run.tell("front Z, rms as it is", np.sqrt(np.mean((np.interp(time[used], T, Z) - front[used]) ** 2)))
    run.residual("front Z, rms after the best shift", min(rms))
    run.tell("shift in T", float(-SHIFTS[int(np.argmin(rms))]), note="experiment later than ours where positive")
    time, height = experiment("height", ratio)
    used = time < tau[-1]
    run.residual("height H, rms", np.sqrt(np.mean((np.interp(time[used], tau, H) - height[used]) ** 2)))
    return run.rows


def draw(axes, runs):
    for label, run in runs:
        ratio, T, Z, tau, H = curves(run)
        line, = axes.plot(T, Z, linewidth=0.9, label=label)
        axes.plot(tau, H, linewidth=0.9, color=line.get_color())
    axes.plot(*experiment("front", ratio), "ks", markersize=3.5, markerfacecolor="white", label="experiment, front")
    axes.plot(*experiment("height", ratio), "k^", markersize=3.5, markerfacecolor="white", label="experiment, height")
    axes.set(xlabel="T; t sqrt(g/a)", ylabel="Z; H", ylim=(0, 4.5))
    axes.legend()
