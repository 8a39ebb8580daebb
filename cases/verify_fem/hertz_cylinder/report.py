"""Peak pressure, profile and approach for the force that was found, against Hertz, and what still moves."""
import numpy as np

from undertow_tool.verify.structure import MeasuredStructure

RADIUS, THICKNESS = 1.0, 0.01      # [m] as in mesh.py


class LineContact:
    """A rigid cylinder on a half-space under the force P [N/m]:  a = sqrt(4 P R/(pi E*)),  p = p0 sqrt(1 - x^2/a^2),
    p0 = sqrt(P E*/(pi R)),  E* = E/(1 - nu^2)   [Johnson 1985, Contact Mechanics, Eqs. 4.43 to 4.45]."""

    def __init__(self, force, material):
        self.nu = material["poisson_ratio"]
        self.force, self.modulus = force, material["young_modulus"] / (1 - self.nu**2)
        self.half_width = float(np.sqrt(4 * force * RADIUS / (np.pi * self.modulus)))
        self.peak = float(np.sqrt(force * self.modulus / (np.pi * RADIUS)))

    def pressure(self, x):
        return self.peak * np.sqrt(np.maximum(0, 1 - (x / self.half_width)**2))

    def approach(self, depth):
        """[m] of the surface's middle to a point `depth` below it, for any depth: the strain e_z of the stresses on
        the axis, s_x = -p0/a [(a^2 + 2 z^2)/r - 2 z], s_z = -p0 a/r, r = sqrt(a^2 + z^2)  [Johnson, Eq. 4.46]."""
        a, n = self.half_width, 4000
        z = (np.arange(n) + 0.5) / n * depth
        r = np.sqrt(a**2 + z**2)
        s_x, s_z = -self.peak / a * ((a**2 + 2 * z**2) / r - 2 * z), -self.peak * a / r
        return float(-np.mean(s_z - self.nu / (1 - self.nu) * s_x) * depth / self.modulus)


def profile(run):
    """(x [m], pressure [Pa]) of the block's top nodes at the end."""
    x, u, p = run.fields.read(len(run.fields) - 1, "displacement", "contact_pressure")
    start = x - u
    top = (np.abs(start[:, 2]) < 1e-8) & (np.abs(start[:, 1]) < 1e-8)
    order = np.argsort(start[top, 0])
    return x[top, 0][order], p[top][order]


def approach_of(run, depth):
    """Depth of the node on the axis nearest to `depth`, and how much nearer the surface has come to it   [m], [m]"""
    x, u = run.fields.read(len(run.fields) - 1, "displacement")
    z = (x - u)[:, 2]
    axis = np.flatnonzero((np.abs((x - u)[:, :2]).max(axis=1) < 1e-8) & (z < 1e-8))
    node = axis[np.argmin(np.abs(z[axis] + depth))]
    return float(-z[node]), float(u[node, 2] - u[axis[np.argmax(z[axis])], 2])


def found_force(run):
    """[N/m] of the whole contact, of which the block has half."""
    return 2 * run.mean_of_end("contact.normal") / THICKNESS


def report(results_dir, case, summary):
    run = MeasuredStructure(results_dir, case, summary)
    exact = LineContact(found_force(run), case["fem"]["material"][0])
    x, p = profile(run)
    run.compare("peak pressure", p.max(), exact.peak, "Pa")
    wanted = exact.pressure(x)
    width = np.gradient(x)
    run.residual("pressure, L2", np.sqrt(np.sum(width * (p - wanted)**2) / np.sum(width * wanted**2)))
    # p^2 falls linearly in x^2
    inner = (p > 0.3 * p.max()) & (p < 0.95 * p.max())
    slope, at_zero = np.polyfit(x[inner]**2, p[inner]**2, 1)
    run.compare("half width", np.sqrt(-at_zero / slope), exact.half_width, "m")
    depth, approach = approach_of(run, 2 * exact.half_width)
    run.compare("approach of the surface to a point below", approach, exact.approach(depth), "m")
    run.residual("still moving", run.unrest("contact.normal"))
    return run.rows


def draw(axes, runs):
    for label, run in runs:
        x, p = profile(run)
        axes.plot(1e3 * x, p / 1e6, ".-", linewidth=0.6, markersize=3, label=label)
    run = runs[-1][1]
    exact = LineContact(found_force(run), run.case["fem"]["material"][0])
    x = np.linspace(0, 1.4 * exact.half_width, 400)
    axes.plot(1e3 * x, exact.pressure(x) / 1e6, "k--", linewidth=0.8, label="Hertz")
    axes.set(xlabel="x [mm]", ylabel="pressure [MPa]", xlim=(0, 1.4e3 * exact.half_width))
    axes.legend(fontsize=7)
