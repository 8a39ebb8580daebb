"""A heap at rest: how far it ran, its profile against that of a thin layer at yield, and how fast it still creeps."""
import numpy as np

from undertow_tool.verify.measured import Measured

INNER = (0.05, 0.9)                     # of the runout, over which profiles are compared: beside middle and front


def length_at_yield(run):
    """Y = tau_y/(rho g) [m]"""
    fluid = run.case["sph"]["fluid"][0]
    return fluid["yield_stress"] / (fluid["density"] * -run.gravity[2])


def volume_of(run, step):
    """Per width [m2]: as compressed as it is."""
    x, density = run.fields.read(step, "density")
    return float(np.sum(run.masses(step, len(x)) / density)) / run.case["case"]["thickness"]


def rest_profile(x, front, Y, front_height):
    """h [m] of a layer at yield that ends in a front of this height: pi Y/2, or 0 to leading order."""
    return np.where(x < front, front_height + np.sqrt(2 * Y * np.maximum(front - x, 0)), 0)


def rest_front(volume, Y, front_height):
    """x_f [m]: front_height x_f + 2/3 sqrt(2 Y) x_f^(3/2) = volume, by bisection."""
    low, high = 0.0, (1.5 * volume / np.sqrt(2 * Y)) ** (2 / 3)
    for _ in range(60):
        middle = 0.5 * (low + high)
        if front_height * middle + 2 / 3 * np.sqrt(2 * Y) * middle**1.5 < volume:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def heights(run, step, at, width):
    """Height [m] of the columns of this width around `at`: their particles' volume over it. A particle counts by the
    share of its spacing that lies in the column, and so does its image beyond the plane of symmetry."""
    x, density = run.fields.read(step, "density")
    volume = run.masses(step, len(x)) / density / run.case["case"]["thickness"]
    found = np.empty(len(at))
    for k, middle in enumerate(at):
        share = sum(np.clip((0.5 * (width + run.dx) - np.abs(side * x[:, 0] - middle)) / run.dx, 0, 1) for side in (1, -1))
        found[k] = np.sum(volume * share) / width
    return found


def runout(run, step, Y):
    """Where the height falls through half of the front's, pi Y/4 [m]."""
    at = np.arange(0, run.fields.read(step)[0][:, 0].max() + 4 * run.dx, 0.25 * run.dx)
    h, wanted = heights(run, step, at, Y), np.pi * Y / 4
    k = np.flatnonzero(h >= wanted)[-1]
    return float(at[k] + (at[k + 1] - at[k]) * (h[k] - wanted) / (h[k] - h[k + 1]))


def report(results_dir, case, summary):
    run = Measured(results_dir, case, summary)
    Y, last = length_at_yield(run), len(run.fields) - 1
    volume = volume_of(run, last)
    front_height = 0.5 * np.pi * Y
    front = rest_front(volume, Y, front_height)
    found = runout(run, last, Y)
    run.compare("runout", found, front, "m")
    run.compare("runout, against leading order", found, rest_front(volume, Y, 0), "m")
    middle = np.linspace(0, 2 * Y, 50)
    run.compare("height of the middle, 2 Y wide", heights(run, last, [0.0], 4 * Y)[0],
                np.mean(rest_profile(middle, front, Y, front_height)), "m")
    at = np.linspace(INNER[0] * front, INNER[1] * front, 30)
    exact, h = rest_profile(at, front, Y, front_height), heights(run, last, at, Y)
    run.residual("profile, rms over rms", np.sqrt(np.mean((h - exact) ** 2) / np.mean(exact**2)))
    before = run.fields.nearest(0.75 * run.times[-1])
    run.residual("runout, change in the last quarter", found / runout(run, before, Y) - 1)
    x, v = run.fields.read(last, "velocity")
    run.tell("largest speed at the end", 1e3 * np.max(np.linalg.norm(v, axis=1)), "mm/s")
    x, = run.fields.read(last)
    run.tell("foremost particle", x[:, 0].max() + 0.5 * run.dx, "m")
    mud = run.sph["fluid"][case["sph"]["fluid"][0]["name"]]
    run.tell("share of the volume that stands (above half the largest viscosity)", mud["share_at_max_viscosity"])
    run.tell("largest shear rate of what stands", mud["creep_rate_1_s"], "1/s")
    return run.rows


def draw(axes, runs):
    for label, run in runs:
        last = len(run.fields) - 1
        x, = run.fields.read(last)
        axes.plot(x[:, 0], x[:, 2], ".", markersize=max(0.5, 400 * run.dx), alpha=0.5, label=label)
    Y, volume = length_at_yield(run), volume_of(run, last)
    for height, style, label in ((0.5 * np.pi * Y, "k-", "next order"), (0, "k:", "leading order")):
        front = rest_front(volume, Y, height)
        at = np.append(np.linspace(0, front * (1 - 1e-9), 200), front)
        axes.plot(at, rest_profile(at, front, Y, height), style, linewidth=0.9, label=label)
    axes.set(xlabel="x [m]", ylabel="z [m]", ylim=(0, None))
    axes.legend(fontsize=7)
