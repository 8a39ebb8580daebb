"""Two layers at rest: weight on the floor, pressure through the interface, what moves, what mixes.

The report of every case with the lower fluid as sph.fluid 1 under the upper one, sph.fluid 0.
"""
import numpy as np

from .measured import Measured


def layers(run):
    """(density of the upper, of the lower fluid [kg/m3], height of the interface, of the surface [m])."""
    upper, lower = run.case["sph"]["fluid"]
    boxes = [fill["box"] for fill in run.case["sph"]["fill"]]
    return upper["density"], lower["density"], boxes[1]["max"][2], boxes[0]["max"][2]


def exact_pressure(run, z):
    upper, lower, interface, surface = layers(run)
    return -run.gravity[2] * (upper * (surface - np.maximum(z, interface)) + lower * np.maximum(0, interface - z))


def report(results_dir, case, summary):
    run = Measured(results_dir, case, summary)
    _, _, interface, surface = layers(run)
    bottom = exact_pressure(run, np.zeros(1))[0]
    forces = run.history("forces")
    late = forces["t"] > 0.5 * forces["t"][-1]
    width = case["sph"]["fill"][0]["box"]["max"][0]
    floor = sum(float(np.mean(-forces[f"floor.{fluid['name']}.fz"][late])) for fluid in case["sph"]["fluid"])
    run.compare("force on the floor", floor, bottom * width * case["case"]["thickness"], "N")

    step = len(run.fields) - 1
    x, p = run.fields.read(step, "pressure")
    run.residual("pressure, rms", np.sqrt(np.mean((p - exact_pressure(run, x[:, 2])) ** 2)) / bottom)
    rms = [np.sqrt(np.mean(np.sum(run.at(t, "velocity")[1] ** 2, axis=1))) for t in run.times if t > 0.5 * run.times[-1]]
    run.residual("speed, rms of the second half", max(rms) / np.sqrt(-run.gravity[2] * surface))
    fluid = run.fluid_of(step, len(x))
    over = (fluid == 1) & (x[:, 2] > interface + 0.5 * run.dx)
    under = (fluid == 0) & (x[:, 2] < interface - 0.5 * run.dx)
    run.residual("particles beyond the interface", float(over.sum() + under.sum()) / (2 * width / run.dx))
    return run.rows


def draw(axes, runs):
    for label, run in runs:
        x, p = run.at(run.times[-1], "pressure")
        axes.plot(p / 1e3, x[:, 2], ".", markersize=2, label=label)
    z = np.linspace(0, layers(run)[3], 50)
    axes.plot(exact_pressure(run, z) / 1e3, z, "k--", linewidth=0.8, label="exact")
    axes.set(xlabel="p [kPa]", ylabel="z [m]")
    axes.legend()
