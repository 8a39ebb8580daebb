"""Water at rest: force on the floor, pressure in the column, what moves, what drifts."""
import numpy as np

from undertow_tool.verify.measured import Measured


def report(results_dir, case, summary):
    run = Measured(results_dir, case, summary)
    fluid, fill = case["sph"]["fluid"][0], case["sph"]["fill"][0]
    rho, g = fluid["density"], -run.gravity[2]
    width, height = (fill["box"]["max"][k] - fill["box"]["min"][k] for k in (0, 2))
    pressure, speed = rho * g * height, np.sqrt(g * height)

    forces = run.history("forces")
    late = forces["t"] > 0.5 * forces["t"][-1]
    floor = float(np.mean(-forces["floor.water.fz"][late]))
    run.compare("force on the floor", floor, rho * g * width * height * case["case"]["thickness"], "N")
    gauges = run.history("gauges")
    run.compare("pressure at the bottom", float(np.mean(gauges["bottom"][late[:len(gauges["t"])]])), pressure, "Pa")

    x, p = run.at(run.times[-1], "pressure")
    run.residual("pressure, rms", np.sqrt(np.mean((p - rho * g * (height - x[:, 2])) ** 2)) / pressure)
    rms = [np.sqrt(np.mean(np.sum(run.at(t, "velocity")[1] ** 2, axis=1))) for t in run.times if t > 0.5 * run.times[-1]]
    run.residual("speed, rms of the second half", max(rms) / speed)
    center = [float(np.mean(run.at(t)[0][:, 2])) for t in run.times]
    run.residual("center of mass, drift", (center[-1] - center[0]) / height)
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
