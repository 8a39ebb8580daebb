"""Water at rest: force on the floor, pressure in the column, what moves, what drifts."""
import numpy as np

from undertow_tool.verify.measured import Measured

SOAKED = (10_000, 30_000, 100_000)      # steps after which a soak is looked at


def soaked(run, steps, t, pressure, speed, center):
    """Rows about the state after so many steps, at time t: the step hardly changes at rest. Pressure and speed are
    those of the last tenth of that time."""
    gauges, height = run.history("gauges"), speed**2 / -run.gravity[2]
    inside = (gauges["t"] > 0.9 * t) & (gauges["t"] <= t * (1 + 1e-9))
    bottom = float(np.mean(gauges["bottom"][inside]))
    run.residual(f"after {steps:.0e} steps: pressure at the bottom", bottom / pressure - 1)
    rms = [np.sqrt(np.mean(np.sum(run.at(s, "velocity")[1] ** 2, axis=1))) for s in run.times if 0.9 * t < s <= t * (1 + 1e-9)]
    run.residual(f"after {steps:.0e} steps: speed, rms", max(rms) / speed)
    drift = center[run.fields.nearest(t)] - center[0]
    run.residual(f"after {steps:.0e} steps: center of mass, drift", drift / height)


def report(results_dir, case, summary):
    run = Measured(results_dir, case, summary)
    fluid, fill = case["sph"]["fluid"][0], case["sph"]["fill"][0]
    rho, g = fluid["density"], -run.gravity[2]
    width, depth, height = (fill["box"]["max"][k] - fill["box"]["min"][k] for k in range(3))
    area = width * (depth if case["case"]["dimension"] == 3 else case["case"]["thickness"])
    pressure, speed = rho * g * height, np.sqrt(g * height)

    forces = run.history("forces")
    late = forces["t"] > 0.5 * forces["t"][-1]
    floor = float(np.mean(-forces["floor.water.fz"][late]))
    run.compare("force on the floor", floor, rho * g * height * area, "N")
    gauges = run.history("gauges")
    run.compare("pressure at the bottom", float(np.mean(gauges["bottom"][late[:len(gauges["t"])]])), pressure, "Pa")

    x, p = run.at(run.times[-1], "pressure")
    run.residual("pressure, rms", np.sqrt(np.mean((p - rho * g * (height - x[:, 2])) ** 2)) / pressure)
    rms = [np.sqrt(np.mean(np.sum(run.at(t, "velocity")[1] ** 2, axis=1))) for t in run.times if t > 0.5 * run.times[-1]]
    run.residual("speed, rms of the second half", max(rms) / speed)
    center = [float(np.mean(run.at(t)[0][:, 2])) for t in run.times]
    run.residual("center of mass, drift", (center[-1] - center[0]) / height)
    run.residual("center of mass, drift of the second half", (center[-1] - center[run.fields.nearest(0.5 * run.times[-1])]) / height)
    for steps in SOAKED if summary["steps"] >= 0.99 * SOAKED[-1] else ():
        soaked(run, steps, steps * summary["dt_mean"], pressure, speed, center)
    return run.rows


def draw(axes, runs):
    for label, run in runs:
        x, p = run.at(run.times[-1], "pressure")
        axes.plot(p / 1e3, x[:, 2], ".", markersize=2, label=label)
    fluid = run.case["sph"]["fluid"][0]
    height = run.case["sph"]["fill"][0]["box"]["max"][2]
    axes.plot([fluid["density"] * -run.gravity[2] * height / 1e3, 0], [0, height], "k--", linewidth=0.8, label="exact")
    axes.set(xlabel="p [kPa]", ylabel="z [m]")
    axes.legend()
