"""Shock against a wall: its speed from where the pressure passes half, and the state behind it."""
import numpy as np

from undertow_tool.verify.measured import Measured


def hugoniot(run):
    """(Us, up [m/s], p [Pa], rho [kg/m3]) behind the shock."""
    fluid = run.case["sph"]["fluid"][0]
    up = -run.case["sph"]["fill"][0]["velocity"][0]
    us = fluid["sound_speed"] + fluid["hugoniot_slope"] * up
    return us, up, fluid["density"] * us * up, fluid["density"] * us / (us - up)


def profile(run, t, name):
    """Mean of a field over slices one spacing thick: (x [m], value), from the wall outward."""
    x, value = run.at(t, name)
    slices = np.round(x[:, 0] / run.dx - 0.5).astype(int)
    count = np.bincount(slices)
    used = count > 0
    return ((np.arange(len(count)) + 0.5) * run.dx)[used], (np.bincount(slices, value) / np.maximum(count, 1))[used]


def shock_position(run, t, pressure):
    """Outermost place where the mean pressure passes half of the shock's [m]."""
    x, p = profile(run, t, "pressure")
    k = np.flatnonzero(p > 0.5 * pressure)[-1]
    return x[k] + (0.5 * pressure - p[k]) / (p[k + 1] - p[k]) * (x[k + 1] - x[k])


def report(results_dir, case, summary):
    run = Measured(results_dir, case, summary)
    us, up, pressure, density = hugoniot(run)
    times = [t for t in run.times if 0.3 * run.times[-1] <= t <= run.times[-1]]
    speed = np.polyfit(times, [shock_position(run, t, pressure) for t in times], 1)[0]
    run.compare("shock speed Us", speed + up, us, "m/s")
    t = times[-1]
    plateau = (0.15 * (us - up) * t, 0.8 * (us - up) * t)     # off the wall and off the shock's own thickness
    for name, field, wanted, unit in (("pressure behind it", "pressure", pressure, "Pa"),
                                      ("density behind it, less rho0", "density", density, "kg/m3")):
        x, value = profile(run, t, field)
        inside = (x > plateau[0]) & (x < plateau[1])
        base = case["sph"]["fluid"][0]["density"] if field == "density" else 0.0
        run.compare(name, np.mean(value[inside]) - base, wanted - base, unit)
        if field == "pressure":
            run.residual("pressure behind it, rms of its ripple", np.std(value[inside]) / pressure)
    x, v = run.at(t, "velocity")
    run.residual("speed across the channel, rms", np.sqrt(np.mean(v[:, 2] ** 2)) / up)
    return run.rows


def draw(axes, runs):
    for label, run in runs:
        x, p = profile(run, run.times[-1], "pressure")
        axes.plot(x, p / 1e6, linewidth=0.9, label=label)
    us, up, pressure, _ = hugoniot(run)
    front = (us - up) * run.times[-1]
    axes.plot([0, front, front, 1.0], np.array([1, 1, 0, 0]) * pressure / 1e6, "k--", linewidth=0.7, label="exact")
    axes.set(xlabel="x [m]", ylabel="p [MPa]")
    axes.legend()
