#!/usr/bin/python3
"""A rigid plane wall on a spring and a damper: a structure of one degree of freedom, in place of
fem_solver. Reads [backend.spring_wall] of the case:

    [backend.spring_wall]
    origin = [0.6, 0.0, 0.0]     # [m] a corner of the wall's face
    u = [0.0, 0.15, 0.0]         # [m] its edges; the fluid is on the side of u x v
    v = [0.0, 0.0, 0.3]          # [m]
    divisions = [6, 12]          # facets along u and v
    mass = 2.0                   # [kg] moving
    stiffness = 5e4              # [N/m] of the whole wall against motion along its normal
    damping_ratio = 0.02         # of critical
    surface = "wall"             # name of the coupled surface
"""
import sys

import numpy as np
from backend import Energies, InputError, grid, main, stable_factor

LARGEST_STEP = 1e-3      # [s] a slow wall must not carry the fluid over its own scales


class SpringWall:
    """m q'' + c q' + k q = F_n, q along the normal; every node moves alike."""

    limiter = "spring of the wall"
    changing = "q", "q_dot", "last_dt", "books", "shown", "least", "most", "force_max", "impulse"
    columns = "displacement [m]", "velocity [m/s]", "force [N]"

    def __init__(self, table):
        origin, u, v = (table.numbers(key, 3) for key in ("origin", "u", "v"))
        n_u, n_v = table.counts("divisions", 2)
        self.mass, self.stiffness = table.number("mass", above=0), table.number("stiffness", least=0)
        ratio = table.number("damping_ratio", 0.0, least=0)
        self.surface = table.word("surface", "wall")
        normal = np.cross(u, v)
        if not np.linalg.norm(normal) > 0:
            raise InputError(f"{table.name}: u and v must not be parallel")
        self.normal = normal / np.linalg.norm(normal)
        self.damping = 2 * ratio * np.sqrt(self.stiffness * self.mass)      # [N s/m]
        a, b, self.quad = grid(n_u, n_v)
        self.x0 = origin + a * u + b * v
        share = np.bincount(self.quad.ravel(), minlength=len(self.x0)) / (4 * n_u * n_v)
        self.nodal_mass = self.mass * share      # by tributary area
        self.q = self.q_dot = 0.0        # [m] at t, [m/s] at t - dt/2
        self.last_dt = 0.0               # [s] 0: the first kick is half a step
        self.books, self.shown = Energies(), (0.0, 0.0, 0.0)
        self.least = self.most = self.force_max = self.impulse = 0.0
        self.description = f"{self.mass:g} kg, {self.stiffness:g} N/m"

    def stable_step(self, contact_share):
        if self.stiffness == 0:
            return LARGEST_STEP
        omega = np.sqrt(self.stiffness / self.mass)
        return min(stable_factor(contact_share) * 2 / omega, LARGEST_STEP)

    def step(self, f, dt):
        """Leapfrog; the damper acts on the mean of the old and the new speed, so that it does not
        lower the stable step."""
        force = float((f @ self.normal).sum())       # [N] along the normal
        self.shown = self.q, self.q_dot, force
        kick = 0.5 * (self.last_dt + dt)
        drag = 0.5 * kick * self.damping / self.mass
        before = self.q_dot
        self.q_dot = ((1 - drag) * before
                      + kick * (force - self.stiffness * self.q) / self.mass) / (1 + drag)
        self.books.book(np.array([before]), np.array([self.q_dot]), self.mass,
                        0.5 * self.stiffness * self.q ** 2, [force],
                        [self.damping * 0.5 * (before + self.q_dot)], self.last_dt)
        self.q += dt * self.q_dot
        self.last_dt = dt
        self.force_max, self.impulse = max(self.force_max, abs(force)), self.impulse + force * dt
        self.least, self.most = min(self.least, self.shown[0]), max(self.most, self.shown[0])
        if not np.isfinite(self.q):
            raise ArithmeticError(f"the wall's displacement is {self.q} after a force of {force} N")

    def positions(self):
        return self.x0 + self.q * self.normal

    def velocities(self):
        return np.tile(self.q_dot * self.normal, (len(self.x0), 1))

    def energies(self):
        return self.books.row()

    def motion(self):
        return self.shown

    def summary(self):
        return {"max_displacement": max(self.most, -self.least), "displacement_min": self.least,
                "displacement_max": self.most, "force_max": self.force_max, "impulse": self.impulse}


if __name__ == "__main__":
    sys.exit(main("spring_wall", "spring_wall 0.1.0", "A rigid wall on a spring and a damper",
                  SpringWall))
