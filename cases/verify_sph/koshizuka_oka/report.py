"""Front of a collapsing column against Koshizuka and Oka 1996."""
from pathlib import Path

import numpy as np

from undertow_tool.verify.measured import Measured

REFERENCE = Path(__file__).parent / "reference" / "koshizuka_oka1996_front.csv"
SHIFTS = np.linspace(-0.5, 0.5, 201)      # of t sqrt(2g/L): the gate opens in an unknown time
NEAR_WALL = 3.9      # z/L beyond which the far wall is near


def experiment():
    """Series -> (t sqrt(2g/L), z/L)."""
    series = {}
    for line in REFERENCE.read_text().splitlines():
        if line.startswith("#") or line.startswith("series"):
            continue
        name, time, front = line.split(",")
        series.setdefault(name, []).append((float(time), float(front)))
    found = {name: np.array(rows).T for name, rows in series.items()}
    found["B"][0] *= np.sqrt(2 * 9.81 / 1.0)        # seconds, L = 1 m
    return found


def front(run):
    gauges = run.history("gauges")
    length = run.case["sph"]["fill"][0]["box"]["max"][0]
    return gauges["t"] * np.sqrt(2 * -run.gravity[2] / length), gauges["front"] / length


def report(results_dir, case, summary):
    run = Measured(results_dir, case, summary)
    t, z = front(run)
    points = np.concatenate(list(experiment().values()), axis=1)
    used = points[:, (points[1] < NEAR_WALL) & (points[0] < t[-1] - SHIFTS[-1])]
    rms = [np.sqrt(np.mean((np.interp(used[0] + s, t, z) - used[1]) ** 2)) for s in SHIFTS]
    run.residual("front z/L, rms after the best shift", min(rms))
    run.tell("front z/L, rms as it is", np.sqrt(np.mean((np.interp(used[0], t, z) - used[1]) ** 2)))
    run.tell("shift in t sqrt(2g/L)", float(-SHIFTS[int(np.argmin(rms))]), note="experiment later than ours where positive")
    late = used[0] > 1.0
    ours, theirs = (np.polyfit(used[0][late], values[late], 1)[0] for values in (np.interp(used[0], t, z), used[1]))
    run.compare("speed of the front after t* = 1", ours, theirs)
    return run.rows


def draw(axes, runs):
    for label, run in runs:
        axes.plot(*front(run), linewidth=0.9, label=label)
    for (name, (t, z)), mark in zip(experiment().items(), ("ks", "k^")):
        axes.plot(t, z, mark, markersize=3.5, markerfacecolor="white", label=f"experiment, {name}")
    axes.set(xlabel="t sqrt(2g/L)", ylabel="z/L")
    axes.legend()
