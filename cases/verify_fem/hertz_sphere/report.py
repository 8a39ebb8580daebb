"""Peak pressure, profile, radius and approach for the force that was found, against Hertz, and what still moves."""
import numpy as np

from undertow_tool.verify.structure import MeasuredStructure

RADIUS = 1.0      # [m] as in mesh.py


class PointContact:
    """A rigid sphere on a half-space under the force F [N]:  a^3 = 3 F R/(4 E*),  p = p0 sqrt(1 - r^2/a^2),
    p0 = 3 F/(2 pi a^2),  E* = E/(1 - nu^2)   [Johnson 1985, Contact Mechanics, Eqs. 4.22 to 4.24]."""

    def __init__(self, force, material):
        self.nu, self.young = material["poisson_ratio"], material["young_modulus"]
        modulus = self.young / (1 - self.nu**2)
        self.force = force
        self.radius = float((3 * force * RADIUS / (4 * modulus))**(1 / 3))
        self.peak = 3 * force / (2 * np.pi * self.radius**2)

    def pressure(self, r):
        return self.peak * np.sqrt(np.maximum(0, 1 - (r / self.radius)**2))

    def approach(self, depth):
        """[m] of the surface's middle to a point `depth` below it, for any depth: the strain e_z of the stresses on the
        axis, s_z = -p0/(1 + z^2/a^2), s_r = -p0 (1 + nu)(1 - (z/a) atan(a/z)) + p0/2/(1 + z^2/a^2)  [Johnson, Eq. 3.45]."""
        a, n = self.radius, 4000
        z = (np.arange(n) + 0.5) / n * depth / a
        s_z = -self.peak / (1 + z**2)
        s_r = -self.peak * (1 + self.nu) * (1 - z * np.arctan(1 / z)) + 0.5 * self.peak / (1 + z**2)
        return float(-np.mean(s_z - 2 * self.nu * s_r) * depth / self.young)


def profile(run):
    """(r [m], pressure [Pa]) of the block's top nodes at the end, from the middle outward."""
    x, u, p = run.fields.read(len(run.fields) - 1, "displacement", "contact_pressure")
    start = x - u
    top = (np.abs(start[:, 2]) < 1e-8) & (np.hypot(start[:, 0], start[:, 1]) < 0.02)
    r = np.hypot(x[top, 0], x[top, 1])
    order = np.argsort(r)
    return r[order], p[top][order]


def axis_of(run, depth):
    """Depth of the node on the axis nearest to `depth`, how far it has sunk, and how far the surface has   [m], [m], [m]"""
    x, u = run.fields.read(len(run.fields) - 1, "displacement")
    z = (x - u)[:, 2]
    axis = np.flatnonzero((np.abs((x - u)[:, :2]).max(axis=1) < 1e-8) & (z < 1e-8))
    node, top = axis[np.argmin(np.abs(z[axis] + depth))], axis[np.argmax(z[axis])]
    return float(-z[node]), float(-u[node, 2]), float(-u[top, 2])


def found_force(run):
    """[N] of the whole contact, of which the block has a quarter."""
    return 4 * run.mean_of_end("contact.normal")


def report(results_dir, case, summary):
    run = MeasuredStructure(results_dir, case, summary)
    exact = PointContact(found_force(run), case["fem"]["material"][0])
    r, p = profile(run)
    run.compare("peak pressure", p.max(), exact.peak, "Pa")
    wanted = exact.pressure(r)
    run.residual("pressure, L2 over the disk", np.sqrt(np.sum(r * (p - wanted)**2) / np.sum(r * wanted**2)))
    # p^2 falls linearly in r^2
    inner = (p > 0.3 * p.max()) & (p < 0.95 * p.max())
    slope, at_zero = np.polyfit(r[inner]**2, p[inner]**2, 1)
    run.compare("radius", np.sqrt(-at_zero / slope), exact.radius, "m")
    depth, sunk, surface = axis_of(run, 4 * exact.radius)
    run.compare("approach of the surface to a point below", surface - sunk, exact.approach(depth), "m")
    pressed = -float(case["fem"]["motion"][0]["displacement"][2])
    run.compare("approach of the sphere to a point below", pressed - sunk, exact.approach(depth), "m")
    run.residual("still moving", run.unrest("contact.normal"))
    return run.rows


def draw(axes, runs):
    for label, run in runs:
        r, p = profile(run)
        axes.plot(1e3 * r, p / 1e6, ".", markersize=3, label=label)
    run = runs[-1][1]
    exact = PointContact(found_force(run), run.case["fem"]["material"][0])
    r = np.linspace(0, 1.4 * exact.radius, 400)
    axes.plot(1e3 * r, exact.pressure(r) / 1e6, "k--", linewidth=0.8, label="Hertz")
    axes.set(xlabel="r [mm]", ylabel="pressure [MPa]", xlim=(0, 1.4e3 * exact.radius))
    axes.legend(fontsize=7)
