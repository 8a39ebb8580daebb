#!/usr/bin/python3
"""A wall of plane Euler-Bernoulli beams, implicit, in place of fem_solver. Reads [backend.beam]:

    [backend.beam]
    origin = [1.61, 0.0, 0.0]    # [m] a corner of the wall's face
    span = [0.0, 0.0, 0.6]       # [m] along the beams
    width = [0.0, 0.15, 0.0]     # [m] across; the fluid is on the side of span x width
    divisions = [24, 6]          # beam elements along the span, facets across
    ends = ["clamped", "free"]   # at origin and at origin + span: clamped, pinned or free
    across = "rigid"             # one beam as wide as the wall; "loose": one under each line of nodes
    thickness = 0.02             # [m]
    density = 1190               # [kg/m3]
    young_modulus = 3.2e9        # [Pa]
    poisson_ratio = 0.32         # of a wide beam, which cannot bend across: E/(1 - nu^2); 0: narrow
    damping_ratio = 0.0          # of critical, in the first mode (stiffness-proportional)
    largest_step = 0             # [s] 0: a fifth of 1/omega of the first mode
    probe = [1.61, 0.075, 0.3]   # [m] whose displacement is recorded; default: middle of the far end
    surface = "wall"             # name of the coupled surface

Equations: rho A w'' + (E I w_xx)_xx = p, cubic elements with consistent mass; all modes of that system.
Time: Newmark with beta = 1/4, gamma = 1/2 in its three-level form, contact taken at t_n, which is the
leapfrog of the protocol with M + dt^2/4 K for M: no step is too large for stability, and a mode slows by
1/sqrt(1 + (omega dt)^2/4). In modes that is a division, whatever dt does.
"""
import sys

import numpy as np
from backend import Energies, InputError, grid, main

HELD = {"clamped": (True, True), "pinned": (True, False), "free": (False, False)}   # w, slope
GAUSS = np.polynomial.legendre.leggauss(4)      # exact for the mass: degree 6


def element_matrices(length):
    """Stiffness / (E I) and mass / (rho A) of a cubic beam element; w and slope at both ends."""
    stiffness, mass = np.zeros((4, 4)), np.zeros((4, 4))
    for point, weight in zip(*GAUSS):
        s = 0.5 * (1 + point)
        n = np.array([1 - 3 * s**2 + 2 * s**3, length * (s - 2 * s**2 + s**3), 3 * s**2 - 2 * s**3,
                      length * (s**3 - s**2)])
        curvature = np.array([12 * s - 6, length * (6 * s - 4), 6 - 12 * s,
                              length * (6 * s - 2)]) / length**2
        stiffness += 0.5 * weight * length * np.outer(curvature, curvature)
        mass += 0.5 * weight * length * np.outer(n, n)
    return stiffness, mass


def modes_of(n_elements, length, ends, bending, line_mass):
    """omega [1/s] and shapes (nodes, modes) of w, scaled to shape' M shape = 1 kg."""
    size = 2 * (n_elements + 1)
    stiffness, mass = np.zeros((size, size)), np.zeros((size, size))
    k, m = element_matrices(length / n_elements)
    for e in range(n_elements):
        place = np.ix_(range(2 * e, 2 * e + 4), range(2 * e, 2 * e + 4))
        stiffness[place] += bending * k
        mass[place] += line_mass * m
    held = np.zeros(size, bool)
    held[:2], held[-2:] = HELD[ends[0]], HELD[ends[1]]
    free = np.flatnonzero(~held)
    root = np.linalg.cholesky(mass[np.ix_(free, free)])
    inverse = np.linalg.inv(root)
    omega2, shapes = np.linalg.eigh(inverse @ stiffness[np.ix_(free, free)] @ inverse.T)
    full = np.zeros((size, len(free)))
    full[free] = inverse.T @ shapes
    return np.sqrt(np.maximum(omega2, 0)), full[0::2]


class Beam:
    limiter = "first mode of the beam"
    changing = "q", "q_dot", "last_dt", "books", "shown", "peak", "force_max", "impulse"
    columns = "probe displacement [m]", "largest displacement [m]", "force [N]"

    def __init__(self, table):
        origin, span, width = (table.numbers(key, 3) for key in ("origin", "span", "width"))
        self.n_along, self.n_across = table.counts("divisions", 2)
        ends = table.take("ends", None, "two of clamped, pinned, free")
        if not (isinstance(ends, list) and len(ends) == 2 and all(end in HELD for end in ends)):
            table.refuse("ends", ends, "two of clamped, pinned, free")
        if sum(sum(HELD[end]) for end in ends) < 2:
            raise InputError(f"{table.name}: ends = {ends} leave the beam free to fly or to turn; "
                             "clamp one end or pin both")
        loose = table.word("across", "rigid", ("rigid", "loose")) == "loose"
        thickness, density, young = (table.number(key, above=0)
                                     for key in ("thickness", "density", "young_modulus"))
        nu = table.number("poisson_ratio", 0.0, least=0)
        if nu >= 0.5:
            table.refuse("poisson_ratio", nu, "< 0.5")
        ratio = table.number("damping_ratio", 0.0, least=0)
        self.largest_step = table.number("largest_step", 0.0, least=0)
        self.surface = table.word("surface", "wall")
        length, breadth = np.linalg.norm(span), np.linalg.norm(width)
        normal = np.cross(span, width)
        if not np.linalg.norm(normal) > 0:
            raise InputError(f"{table.name}: span and width must not be parallel")
        self.normal = normal / np.linalg.norm(normal)

        a, b, self.quad = grid(self.n_along, self.n_across)
        self.x0 = origin + a * span + b * width
        share = np.bincount(self.quad.ravel(), minlength=len(a)) / (4 * self.n_along * self.n_across)
        self.nodal_mass = density * thickness * length * breadth * share
        # Everything per meter of width; a beam under one line carries half a facet at the edges.
        self.omega, self.shapes = modes_of(self.n_along, length, ends,
                                           young * thickness**3 / (12 * (1 - nu**2)),
                                           density * thickness)
        carried = np.full(self.n_across + 1, breadth / self.n_across)
        carried[[0, -1]] *= 0.5
        self.carried = carried if loose else np.array([breadth])        # [m] of each beam
        self.damping = 2 * ratio / self.omega[0] * self.omega**2        # [1/s] c/m of each mode
        self.q = np.zeros((len(self.omega), len(self.carried)))         # modal amplitudes at t
        self.q_dot = np.zeros_like(self.q)                              # at t - dt/2
        self.last_dt, self.books = 0.0, Energies()
        probe = table.numbers("probe", 3, list(origin + span + 0.5 * width))
        nearest = np.linalg.norm(self.x0 - probe, axis=1).argmin()
        self.probe = divmod(int(nearest), self.n_across + 1)
        self.shown, self.peak, self.force_max, self.impulse = (0.0,) * 3, np.zeros(2), 0.0, 0.0
        self.description = f"{len(self.carried)} beams, first mode {self.omega[0] / 2 / np.pi:.4g} Hz"

    def stable_step(self, _contact_share):
        return self.largest_step or 0.2 / self.omega[0]

    def step(self, f, dt):
        push = (f @ self.normal).reshape(self.n_along + 1, self.n_across + 1)   # [N]
        if len(self.carried) == 1:
            push = push.sum(axis=1, keepdims=True)
        w = self.shapes @ self.q                                                # [m] of each node
        total = float(push.sum())
        row, line = self.probe
        self.shown = w[row, line if len(self.carried) > 1 else 0], w.flat[np.abs(w).argmax()], total
        self.peak = np.maximum(self.peak, np.abs(self.shown[:2]))
        self.force_max, self.impulse = max(self.force_max, abs(total)), self.impulse + total * dt

        load = self.shapes.T @ (push / self.carried)            # [N/m of width] on each mode
        omega2, damping = self.omega[:, None]**2, self.damping[:, None]
        kick = 0.5 * (self.last_dt + dt)
        inertia = 1 + 0.25 * dt * dt * omega2
        drag = 0.5 * kick * damping
        before = self.q_dot
        self.q_dot = ((inertia - drag) * before + kick * (load - omega2 * self.q)) / (inertia + drag)
        self.books.book(before, self.q_dot, inertia * self.carried,
                        0.5 * float((omega2 * self.q**2 * self.carried).sum()), load * self.carried,
                        damping * 0.5 * (before + self.q_dot) * self.carried, self.last_dt)
        self.q = self.q + dt * self.q_dot
        self.last_dt = dt
        if not np.isfinite(self.q).all():
            raise ArithmeticError(f"the beam's displacement is no number after a force of {total} N")

    def spread(self, amplitudes):
        """(N,3) of the face's nodes."""
        w = np.broadcast_to(self.shapes @ amplitudes, (self.n_along + 1, self.n_across + 1))
        return w.reshape(-1, 1) * self.normal

    def positions(self):
        return self.x0 + self.spread(self.q)

    def velocities(self):
        return self.spread(self.q_dot)

    def energies(self):
        return self.books.row()

    def motion(self):
        return self.shown

    def summary(self):
        return {"first_frequency": self.omega[0] / 2 / np.pi, "beams": len(self.carried),
                "probe_displacement_max": self.peak[0], "max_displacement": self.peak[1], "force_max": self.force_max,
                "impulse": self.impulse}


if __name__ == "__main__":
    sys.exit(main("beam", "beam 0.1.0", "A wall of Euler-Bernoulli beams", Beam))
