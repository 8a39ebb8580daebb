"""Velocity and displacement of both blocks, against rigid ones, and the friction while it slides."""
import numpy as np

from undertow_tool.verify.structure import MeasuredStructure

SIDE, AMPLITUDE = 0.2, 0.01      # [m] as in mesh.py; [m] as in case.toml


def plate(run):
    """Times [s], displacement [m] and velocity [m/s] of what is told."""
    t, x = run.probe("motion shaker.ux")
    return t, x, np.gradient(x, t)


def rigid_block(run, at, finer=20):
    """Displacement [m] and velocity [m/s] at times `at`: in each small step the velocity follows the plate's by mu g at most
    [Newmark, Geotechnique 15, 1965]."""
    rows, _, v_plate = plate(run)
    t = np.linspace(0, rows[-1], finer * len(rows))
    of_plate, most = np.interp(t, rows, v_plate), -run.case["fem"]["contact"][1]["friction"] * run.gravity[2] * t[1]
    v = np.zeros_like(t)
    for k in range(len(t) - 1):
        v[k + 1] = v[k] + min(most, max(-most, of_plate[k + 1] - v[k]))
    x = np.concatenate(([0], np.cumsum(0.5 * (v[1:] + v[:-1])) * t[1]))
    return np.interp(at, t, x), np.interp(at, t, v)


def report(results_dir, case, summary):
    run = MeasuredStructure(results_dir, case, summary)
    left, right = run.history("fem.history.left"), run.history("fem.history.right")
    t = left["t"]
    rows, x_plate, v_plate = plate(run)
    x_plate = np.interp(t, rows, x_plate)
    run.residual("sticking: largest slip over the plate's way", np.abs(left["ux"] - x_plate).max() / (2 * AMPLITUDE))
    x, v = rigid_block(run, t)
    run.residual("sliding: velocity, L2", np.sqrt(np.mean((right["vx"] - v)**2) / np.mean(v**2)))
    run.residual("sliding: displacement, L2", np.sqrt(np.mean((right["ux"] - x)**2) / np.mean(x**2)))
    run.compare("sliding: displacement at the end", right["ux"][-1], x[-1], "m")
    weight = -case["fem"]["material"][0]["density"] * SIDE**3 * run.gravity[2]
    slides = np.abs(np.interp(rows, t, v) - v_plate) > 0.03
    friction = np.mean(np.abs(run.probe("right.tx")[1][slides]))
    run.compare("sliding: friction", friction, case["fem"]["contact"][1]["friction"] * weight, "N")
    return run.rows


def draw(axes, runs):
    """Velocities of the finest run."""
    run = runs[-1][1]
    right, left = run.history("fem.history.right"), run.history("fem.history.left")
    t = right["t"]
    axes.plot(plate(run)[0], plate(run)[2], color="#bbbbbb", linewidth=2.5, label="plate")
    axes.plot(t, left["vx"], color="#2a9d8f", linewidth=0.8, label="sticks")
    axes.plot(t, right["vx"], color="#3b7dd8", linewidth=1.2, label="slides")
    axes.plot(t, rigid_block(run, t)[1], "k--", linewidth=0.8, label="rigid")
    axes.set(xlabel="t [s]", ylabel="velocity [m/s]")
    axes.legend(fontsize=7)
