"""Two drops: what is conserved to round-off, and what stays symmetric."""
import numpy as np

from undertow_tool.verify.measured import Measured

FLATTENED = 0.12     # [s] they meet at 0.1 s; later every round-off grows, as it must in a splash


def asymmetry(run, t):
    """Largest distance between a particle's mirror image at x = 0 and the nearest particle [dx]."""
    x, = run.at(t)
    points = x[:, [0, 2]]
    image = points * np.array([-1, 1])
    worst = 0.0
    for start in range(0, len(points), 500):
        d2 = np.sum((image[start:start + 500, None, :] - points[None, :, :]) ** 2, axis=2)
        worst = max(worst, float(np.sqrt(d2.min(axis=1)).max()))
    return worst / run.dx


def report(results_dir, case, summary):
    run = Measured(results_dir, case, summary)
    linear, size = run.momentum()
    run.residual("linear momentum over sum m |v|", np.abs(linear - linear[0]).max() / size[0])
    turning, scale = [], 0.0
    for step in range(len(run.fields)):
        x, v = run.fields.read(step, "velocity")
        m = run.masses(step, len(x))
        turning.append(float(m @ (x[:, 2] * v[:, 0] - x[:, 0] * v[:, 2])))
        scale = max(scale, float(m @ (np.hypot(x[:, 0], x[:, 2]) * np.linalg.norm(v, axis=1))))
    run.residual("angular momentum over sum m r |v|", max(abs(t - turning[0]) for t in turning) / scale)
    run.residual("mirror symmetry in the impact, largest distance/dx", asymmetry(run, FLATTENED))
    energy = run.history("energy.sph")
    total = energy["kinetic"] + energy["elastic"]
    run.residual("energy, largest gain", max(0.0, float(np.max(total / total[0]) - 1)))
    return run.rows


def draw(axes, runs):
    label, run = runs[-1]
    for k, t in enumerate((0.0, 0.1, 0.2, 0.4)):
        x, p = run.at(t, "pressure")
        axes.scatter(x[:, 0] + 1.3 * (k % 2), x[:, 2] - 1.3 * (k // 2), c=p / 1e3, s=0.5, cmap="coolwarm", vmin=-4, vmax=4)
        axes.text(1.3 * (k % 2) - 0.5, 0.4 - 1.3 * (k // 2), f"{t:g} s", fontsize=7)
    axes.set(aspect="equal", xlabel="x [m]", ylabel="z [m]")
    axes.grid(False)
