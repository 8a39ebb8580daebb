"""Rotating patch: what must stay as it was, and whether the patch holds together."""
import numpy as np

from undertow_tool.verify.measured import Measured


SUCTION = -147.3            # [Pa] -0.1473 rho w^2 L^2: the series of case.toml at x = z = 0
EARLY = (0.1, 0.5)          # w t: after the sound of the start, before the square is much of an octagon


def nearest_distance(x, others=None):
    """Of each point to the nearest other one, in the x-z plane [m]; plain numpy, in blocks."""
    points = x[:, [0, 2]]
    targets = points if others is None else others[:, [0, 2]]
    found = np.empty(len(points))
    for start in range(0, len(points), 500):
        d2 = np.sum((points[start:start + 500, None, :] - targets[None, :, :]) ** 2, axis=2)
        if others is None:
            d2[np.arange(len(d2)), start + np.arange(len(d2))] = np.inf
        found[start:start + 500] = np.sqrt(d2.min(axis=1))
    return found


def crowding(x, dx):
    """Mean number of particles within two spacings of a particle, itself included: where the fluid keeps its
    area this stays as it was but for those at the surface."""
    points, total = x[:, [0, 2]], 0
    for start in range(0, len(points), 500):
        d2 = np.sum((points[start:start + 500, None, :] - points[None, :, :]) ** 2, axis=2)
        total += np.count_nonzero(d2 < (2.1 * dx) ** 2)
    return total / len(points)


def distance_to_surface(x, dx):
    """Of each particle [m]. At the surface is who has its neighbors within three spacings on one side: their middle is
    more than 0.6 spacings away (0.9 to 1.3 at a straight surface)."""
    points, offset = x[:, [0, 2]], np.empty(len(x))
    for start in range(0, len(points), 500):
        apart = points[None, :, :] - points[start:start + 500, None, :]
        near = np.sum(apart**2, axis=2) < (3 * dx) ** 2
        middle = np.sum(apart * near[:, :, None], axis=1) / np.maximum(near.sum(axis=1), 1)[:, None]
        offset[start:start + 500] = np.linalg.norm(middle, axis=1)
    return nearest_distance(x, x[offset > 0.6 * dx])


def report(results_dir, case, summary):
    run = Measured(results_dir, case, summary)
    steps = [run.fields.nearest(t) for t in (0.0, 1.0, 2.0, run.times[-1])]
    states = [run.fields.read(step, "velocity") for step in steps]
    mass = run.masses(0, len(states[0][0]))
    turning = [float(mass @ (x[:, 2] * v[:, 0] - x[:, 0] * v[:, 2])) for x, v in states]
    kinetic = [float(mass @ np.sum(v**2, axis=1)) for _, v in states]
    gauges = run.history("gauges")
    early = (gauges["t"] > EARLY[0]) & (gauges["t"] < EARLY[1])
    run.compare("suction at the center, 0.1 < w t < 0.5", np.mean(gauges["center"][early]), SUCTION, "Pa",
                "of the square at w t = 0; it weakens with the square of time")
    run.residual("angular momentum at w t = 4, change", turning[-1] / turning[0] - 1)
    run.residual("kinetic energy at w t = 2, change", kinetic[2] / kinetic[0] - 1)
    run.residual("kinetic energy at w t = 4, change", kinetic[-1] / kinetic[0] - 1)
    first = crowding(states[0][0], run.dx)
    for name, (x, _) in (("w t = 1", states[1]), ("w t = 2", states[2])):
        run.residual(f"particles per area at {name}, change", crowding(x, run.dx) / first - 1)
    for name, (x, _) in (("w t = 2", states[2]), ("w t = 4", states[-1])):
        turned = np.column_stack([x[:, 2], x[:, 1], -x[:, 0]])     # by a quarter turn
        run.residual(f"four-fold symmetry at {name}, rms distance/dx",
                     np.sqrt(np.mean(nearest_distance(turned, x) ** 2)) / run.dx)
        clumped, deep = nearest_distance(x) < 0.5 * run.dx, distance_to_surface(x, run.dx) > 2 * run.dx
        run.residual(f"particles clumped inside at {name}", float(np.mean(clumped[deep])) if deep.any() else 0.0)
        run.tell(f"particles clumped at {name}, at the surface too", float(np.mean(clumped)))
    return run.rows


def draw(axes, runs):
    label, run = runs[-1]
    for k, t in enumerate((0.0, 0.5, 1.0, 2.0)):
        x, p = run.at(t, "pressure")
        axes.scatter(x[:, 0] + 2.0 * (k % 2), x[:, 2] - 2.0 * (k // 2), c=p, s=0.6, cmap="coolwarm", vmin=-100, vmax=100)
        axes.text(2.0 * (k % 2) - 0.9, 0.8 - 2.0 * (k // 2), f"w t = {t:g}", fontsize=7)
    axes.set(aspect="equal", xlabel="x [m]", ylabel="z [m]")
    axes.grid(False)
