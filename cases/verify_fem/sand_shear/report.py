"""Shear stress and dilation of a layer of sand that flows, against Davis (1968)."""
import numpy as np

from undertow_tool.verify.structure import MeasuredStructure

LENGTH, DEPTH, HEIGHT = 1.0, 0.25, 0.25      # [m] as in mesh.py


def course(run):
    """(shear strain, height strain, shear stress [Pa]) over time."""
    history = run.history("fem.history")
    return history["cap.ux"] / HEIGHT, history["cap.uz"] / HEIGHT, history["motion drag.fx"] / (LENGTH * DEPTH)


def report(results_dir, case, summary):
    run = MeasuredStructure(results_dir, case, summary)
    sand, p = case["fem"]["material"][0], case["fem"]["pressure"][0]["value"]
    phi, psi = np.radians(sand["friction_angle"]), np.radians(sand["dilation_angle"])
    exact = np.cos(psi) * (sand["cohesion"] * np.cos(phi) + p * np.sin(phi)) / (1 - np.sin(phi) * np.sin(psi))
    shear, height, stress = course(run)
    run.compare("shear stress", float(np.mean(stress[-20:])), float(exact), "Pa")
    half = len(shear) // 2
    run.compare("height over shear strain", float((height[-1] - height[half]) / (shear[-1] - shear[half])),
                float(np.tan(psi)))
    return run.rows


def draw(axes, runs):
    """Shear stress and height of all runs over the shear strain."""
    other = axes.twinx()
    for name, run in runs:
        shear, height, stress = course(run)
        axes.plot(100 * shear, 1e-3 * stress, label=name)
        other.plot(100 * shear, 100 * height, linestyle=":")
    axes.set(xlabel="shear strain [%]", ylabel="shear stress [kPa]")
    other.set_ylabel("height strain [%] (dotted)")
    axes.legend(fontsize=7)
