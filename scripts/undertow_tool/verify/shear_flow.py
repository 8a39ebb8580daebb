"""Flow along x between no-slip planes at the lowest and the highest z: exact profiles, and their report.

A case has periodic x, planes "low" and "high", and fills that span the gap; its report.py is

    from undertow_tool.verify.shear_flow import Channel, report_of
    report, draw = report_of(Channel)
"""
import numpy as np

from .measured import Measured


def gap(run):
    """z of the planes [m]."""
    point = {plane["name"]: plane["point"][2] for plane in run.case["sph"]["plane"]}
    return point["low"], point["high"]


def speed_of_lid(run):
    return next(plane["velocity"][0] for plane in run.case["sph"]["plane"] if plane["name"] == "high")


class Channel:
    """One fluid driven by G = rho g_x [N/m3]: tau = tau_y + K gd^n (Newton: n = 1, K = viscosity).

    u = n/(n+1) (G/K)^(1/n) [(h - z_y)^(1+1/n) - max(0, |z| - z_y)^(1+1/n)], z from the middle, h half the gap,
    z_y = tau_y/G half the plug.
    """
    times = (1.0,)                       # [of the run] when the profile is compared

    def __init__(self, run):
        fluid = run.case["sph"]["fluid"][0]
        low, high = gap(run)
        self.middle, self.h = 0.5 * (low + high), 0.5 * (high - low)
        self.drive = fluid["density"] * run.gravity[0]
        newton = fluid["consistency"] == 0 and fluid["yield_stress"] == 0
        self.consistency, self.index = (fluid["viscosity"], 1.0) if newton else (fluid["consistency"], fluid["flow_index"])
        self.plug = fluid["yield_stress"] / self.drive

    def velocity(self, z, t):
        n, power = self.index, 1 + 1 / self.index
        of = n / (n + 1) * (self.drive / self.consistency) ** (1 / n)
        beyond = np.maximum(0, np.abs(z - self.middle) - self.plug)
        return of * ((self.h - self.plug) ** power - beyond**power)

    def rows(self, run):
        """Stress on the walls: in steady flow G h."""
        run.compare("stress on the walls", wall_stress(run, "low", "high"), self.drive * self.h, "Pa")


class LayeredChannel:
    """Two Newtonian fluids, mu_1 below and mu_2 above the middle, driven by the same G: tau = c - G z,
    c = (G h/2) (mu_1 - mu_2)/(mu_1 + mu_2).
    """
    times = (1.0,)

    def __init__(self, run):
        low, high = gap(run)
        self.middle, self.h = 0.5 * (low + high), 0.5 * (high - low)
        below, above = run.case["sph"]["fluid"]
        self.mu = below["viscosity"], above["viscosity"]
        self.drive = below["density"] * run.gravity[0]
        self.c = 0.5 * self.drive * self.h * (self.mu[0] - self.mu[1]) / (self.mu[0] + self.mu[1])

    def velocity(self, z, t):
        z = z - self.middle
        def from_wall(wall, mu):
            return (self.c * (z - wall) - 0.5 * self.drive * (z**2 - wall**2)) / mu
        return np.where(z < 0, from_wall(-self.h, self.mu[0]), from_wall(self.h, self.mu[1]))

    def rows(self, run):
        found = interface_velocity(run, self, self.middle)
        run.compare("velocity of the interface", found, float(self.velocity(np.array([self.middle]), 0)[0]), "m/s")


class LayeredCouette:
    """The lid drags two Newtonian fluids of equal depth, mu_1 below: u = U/(1 + mu_1/mu_2) between them."""
    times = (1.0,)

    def __init__(self, run):
        low, high = gap(run)
        self.low, self.middle, self.depth = low, 0.5 * (low + high), 0.5 * (high - low)
        below, above = run.case["sph"]["fluid"]
        self.lid = speed_of_lid(run)
        self.between = self.lid / (1 + below["viscosity"] / above["viscosity"])
        self.stress = below["viscosity"] * self.between / self.depth

    def velocity(self, z, t):
        below = self.between * (z - self.low) / self.depth
        above = self.between + (self.lid - self.between) * (z - self.middle) / self.depth
        return np.where(z < self.middle, below, above)

    def rows(self, run):
        run.compare("velocity of the interface", interface_velocity(run, self, self.middle), self.between, "m/s")
        run.compare("stress on the walls", wall_stress(run, "low", "high", opposite=True), self.stress, "Pa")


class StartingCouette:
    """A Newtonian fluid at rest whose lid starts with U: u/U = s + 2 sum_k (-1)^k/(k pi) sin(k pi s) exp(-k^2 pi^2 nu
    t/H^2), s = z/H (Batchelor 1967, section 4.3).
    """
    times = (0.1, 0.3, 1.0)

    def __init__(self, run):
        low, high = gap(run)
        self.low, self.height, self.lid = low, high - low, speed_of_lid(run)
        fluid = run.case["sph"]["fluid"][0]
        self.rate = fluid["viscosity"] / fluid["density"] / self.height**2

    def velocity(self, z, t):
        s, k = (z - self.low) / self.height, np.arange(1, 400)[:, None] * np.pi
        signs = np.where(np.arange(1, 400) % 2, -1.0, 1.0)[:, None]
        return self.lid * (s + np.sum(2 * signs / k * np.sin(k * s) * np.exp(-(k**2) * self.rate * t), axis=0))

    def rows(self, run):
        pass


class SteadyCouette:
    """Any fluid dragged by the lid: u = U z/H, tau = mu_N gd + tau_y + K gd^n with gd = U/H."""
    times = (1.0,)

    def __init__(self, run):
        low, high = gap(run)
        self.low, self.lid, self.rate = low, speed_of_lid(run), speed_of_lid(run) / (high - low)
        fluid = run.case["sph"]["fluid"][0]
        self.stress = (fluid["viscosity"] * self.rate + fluid["yield_stress"]
                       + fluid["consistency"] * self.rate ** fluid["flow_index"])

    def velocity(self, z, t):
        return self.rate * (z - self.low)

    def rows(self, run):
        run.compare("stress on the walls", wall_stress(run, "low", "high", opposite=True), self.stress, "Pa")


def wall_stress(run, *names, opposite=False):
    """Mean of the last tenth of the run and of both planes [Pa]; opposite: the second one drives."""
    forces = run.history("forces")
    late = forces["t"] > 0.9 * forces["t"][-1]
    fluids = [fluid["name"] for fluid in run.case["sph"]["fluid"]]
    length = run.case["sph"]["domain"]["max"][0] - run.case["sph"]["domain"]["min"][0]
    area = length * run.case["case"]["thickness"]
    stress = []
    for name in names:
        columns = [c for c in forces if c == f"{name}.fx" or c in [f"{name}.{fluid}.fx" for fluid in fluids]]
        stress.append(sum(float(np.mean(forces[c][late])) for c in columns) / area)
    return (stress[0] - stress[1]) / 2 if opposite else sum(stress) / len(stress)


def interface_velocity(run, flow, middle):
    """That of the thicker, lower layer: the exact one plus the deviation of its last three layers of particles,
    carried on by the line through them. (The upper one shears so fast that half a spacing is a tenth of it.)"""
    x, v = run.at(run.times[-1], "velocity")
    z = x[:, 2] - middle
    near = (z < 0) & (z > -3 * run.dx)
    deviation = v[near, 0] - flow.velocity(x[near, 2], run.times[-1])
    return float(flow.velocity(np.array([middle]), 0)[0] + np.polyfit(z[near], deviation, 1)[1])


def report_of(exact):
    """report and draw of a case whose exact solution is `exact`."""
    def report(results_dir, case, summary):
        run = Measured(results_dir, case, summary)
        flow = exact(run)
        end = run.times[-1]
        for share in flow.times:
            t = run.times[run.fields.nearest(share * end)]
            x, v = run.at(t, "velocity")
            wanted = flow.velocity(x[:, 2], t)
            error = np.sqrt(np.sum((v[:, 0] - wanted) ** 2) / np.sum(wanted**2))
            name = "velocity, L2 over L2" + (f", at {share:g} of the run" if len(flow.times) > 1 else "")
            run.residual(name, error)
        flow.rows(run)
        return run.rows

    def draw(axes, runs):
        for label, run in runs:
            x, v = run.at(run.times[-1], "velocity")
            axes.plot(v[:, 0], x[:, 2], ".", markersize=2, label=label)
        flow, (low, high) = exact(run), gap(run)
        z = np.linspace(low, high, 300)
        for share in flow.times:
            axes.plot(flow.velocity(z, share * run.times[-1]), z, "k--", linewidth=0.7)
        axes.set(xlabel="u [m/s]", ylabel="z [m]")
        axes.legend()

    return report, draw
