"""Compliance of the tips, against a beam whose principal axes turn, and what still moves."""
import numpy as np

from undertow_tool.verify.structure import MeasuredStructure

LENGTH, WIDTH, APART = 12.0, 1.1, 3.0      # [m] as in mesh.py


def compliance(across, modulus, nu, thickness, n=2000):
    """[m/N] of the tip under a force along (across = False) or across its width. The straight axis of a beam whose section
    turns stays uncoupled from torsion; the moment (L - x) splits on the section's axes, which stand at right angles to those of
    the tip at the root:  u/F = integral (L - x)^2 (cos^2 a/(E I_1) + sin^2 a/(E I_2)) dx + 6/5 L/(G A)."""
    x = (np.arange(n) + 0.5) / n * LENGTH
    flat, upright = WIDTH * thickness**3 / 12, thickness * WIDTH**3 / 12
    of_root, of_tip = (upright, flat) if across else (flat, upright)
    turn = 0.5 * np.pi * x / LENGTH
    bending = np.mean((LENGTH - x)**2 * (np.cos(turn)**2 / of_root + np.sin(turn)**2 / of_tip)) * LENGTH / modulus
    return float(bending + 1.2 * LENGTH / (modulus / (2 * (1 + nu)) * WIDTH * thickness))


def report(results_dir, case, summary):
    run = MeasuredStructure(results_dir, case, summary)
    material = case["fem"]["material"][0]
    for place, tip, axis, across in (("in", "in", "z", False), ("out of", "out", "y", True)):
        exact = compliance(across, material["young_modulus"], material["poisson_ratio"], case["fem"]["part"][0]["thickness"])
        moved, force = run.mean_of_end(f"motion {tip}.u{axis}"), run.mean_of_end(f"motion {tip}.f{axis}")
        run.compare(f"compliance {place} the plane", moved / force, exact, "m/N")
        run.residual(f"still moving, {place} the plane", run.unrest(f"motion {tip}.f{axis}"))
    return run.rows


def draw(axes, runs):
    """The axes of both beams of the finest run."""
    run = runs[-1][1]
    x, u = run.fields.read(len(run.fields) - 1, "displacement")
    start = x - u
    for y, label, color in ((0.0, "in the plane", "#3b7dd8"), (APART, "out of the plane", "#d1495b")):
        at = np.linalg.norm(start[:, 1:] - [y, 0], axis=1) < 1e-6
        order = np.argsort(start[at, 0])
        for d, style in ((1, "-"), (2, "--")):
            axes.plot(start[at, 0][order], 1e6 * u[at, d][order], style, color=color, label=f"{label}, u{'xyz'[d]}")
    axes.set(xlabel="x [m]", ylabel="displacement of the axis [1e-6 m]")
    axes.legend(fontsize=7)
