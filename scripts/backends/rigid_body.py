#!/usr/bin/python3
"""A rigid block with six degrees of freedom on soil springs, in place of fem_solver. Reads

    [backend.rigid_body]
    box = [1.61, 0, 0, 1.71, 0.15, 0.3]  # [m] xmin ymin zmin xmax ymax zmax
    divisions = [2, 4, 8]        # facets along x, y and z; all six faces are coupled
    mass = 8.0                   # [kg]
    inertia = [0, 0, 0]          # [kg m2] about the center, along x, y, z; 0: of the homogeneous box
    base = [1.66, 0.075, 0.0]    # [m] where the springs hold it; default: middle of the lower face
    stiffness = [2e5, 2e5, 4e5]  # [N/m] against displacements of the base along x, y, z
    rocking = [2e3, 2e3, 1e3]    # [N m/rad] against rotations about x, y, z
    damping_ratio = 0.05         # of critical in the first mode, proportional to stiffness
    gravity = [0, 0, 0]          # [m/s2] 0 if the springs are those of the settled body
    surface = "block"            # name of the coupled surface

Equations: m c'' = F + F_base, L' = M + (b - c) x F_base + M_base, about the center c. The springs are
linear in the displacement u_b of the base and in the rotation vector theta of the body:
F_base = -K_u u_b - C_u u_b', M_base = -K_theta theta - C_theta omega. Turns may be large, the springs'
law is meant for small ones. Leapfrog for c and for the angular momentum L; the rotation takes the
angular velocity of the middle of the step.
"""
import sys

import numpy as np
from backend import InputError, grid, main, stable_factor

LARGEST_STEP = 1e-3      # [s] as in spring_wall


def cross_matrix(a):
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def rotation(theta):
    """exp(theta x)  [Rodrigues]"""
    angle = np.linalg.norm(theta)
    if angle < 1e-12:
        return np.eye(3) + cross_matrix(theta)
    axis = cross_matrix(theta / angle)
    return np.eye(3) + np.sin(angle) * axis + (1 - np.cos(angle)) * axis @ axis


def rotation_vector(turn):
    """The theta of rotation(theta), for angles below pi."""
    odd = 0.5 * np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    sine = np.linalg.norm(odd)
    if sine < 1e-12:
        return odd
    return odd * np.arctan2(sine, 0.5 * (np.trace(turn) - 1)) / sine


def box_mesh(low, high, divisions):
    """Nodes and outward facets of the six faces; nodes on edges are shared."""
    size, nodes, quads, index = high - low, [], [], {}
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, 1):
            first, second = (u, v) if side else (v, u)          # so that the normal points outward
            a, b, quad = grid(divisions[first], divisions[second])
            x = np.tile(low, (len(a), 1))
            x[:, axis] += side * size[axis]
            x[:, first] += a[:, 0] * size[first]
            x[:, second] += b[:, 0] * size[second]
            rows = []
            for point in x:
                key = tuple(np.round((point - low) / size * 1e6).astype(int))
                if key not in index:
                    index[key] = len(nodes)
                    nodes.append(point)
                rows.append(index[key])
            quads.append(np.array(rows)[quad])
    return np.array(nodes), np.concatenate(quads)


class RigidBody:
    limiter = "springs of the body"
    changing = ("u", "turn", "v", "momentum", "last_dt", "last", "kinetic", "internal", "damping", "work", "shown",
                "peak", "force_max", "impulse")
    columns = ("base ux [m]", "base uy [m]", "base uz [m]", "theta x [rad]", "theta y [rad]",
               "theta z [rad]", "force x [N]", "force y [N]", "force z [N]")

    def __init__(self, table):
        box = table.numbers("box", 6)
        low, high = box[:3], box[3:]
        if not (high > low).all():
            table.refuse("box", list(box), "xmin ymin zmin xmax ymax zmax, each max above its min")
        self.x0, self.quad = box_mesh(low, high, table.counts("divisions", 3))
        self.mass = table.number("mass", above=0)
        size, self.center = high - low, 0.5 * (low + high)
        inertia = table.numbers("inertia", 3, [0, 0, 0])
        if not inertia.any():
            inertia = self.mass / 12 * ((size**2).sum() - size**2)
        base = table.numbers("base", 3, list((*self.center[:2], low[2])))
        self.k = np.concatenate([table.numbers("stiffness", 3), table.numbers("rocking", 3)])
        if (inertia <= 0).any() or (self.k < 0).any():
            raise InputError(f"{table.name}: inertia must be > 0, stiffness and rocking >= 0")
        ratio = table.number("damping_ratio", 0.0, least=0)
        self.weight = self.mass * table.numbers("gravity", 3, [0, 0, 0])
        self.surface = table.word("surface", "block")

        self.inertia = inertia                       # [kg m2] in the axes of the body
        self.arm = base - self.center                # [m] of the base in the axes of the body
        self.arms = self.x0 - self.center            # of the nodes
        self.omega = self.frequencies()              # [1/s]
        first = self.omega[self.omega > 1e-6 * self.omega[-1]] if self.omega[-1] > 0 else [1.0]
        self.c = 2 * ratio / first[0] * self.k       # [N s/m], [N m s/rad]
        self.nodal_mass = self.felt_masses()

        self.u, self.turn = np.zeros(3), np.eye(3)   # [m] of the center, rotation, at t
        self.v, self.momentum = np.zeros(3), np.zeros(3)     # at t - dt/2: [m/s], [N m s] about it
        self.last_dt, self.last = 0.0, None
        self.kinetic = self.internal = self.damping = self.work = 0.0
        self.shown, self.peak, self.force_max = np.zeros(9), np.zeros(6), 0.0
        self.impulse = np.zeros(3)
        self.description = (f"{self.mass:g} kg, modes at "
                            + ", ".join(f"{w / 2 / np.pi:.4g}" for w in self.omega) + " Hz")

    def frequencies(self):
        """omega of small motions: K from the springs at the base, M = diag(m, I) at the center."""
        reach = np.eye(6)
        reach[:3, 3:] = -cross_matrix(self.arm)      # u_b = u + theta x arm
        stiffness = reach.T @ np.diag(self.k) @ reach
        root = 1 / np.sqrt(np.concatenate([np.full(3, self.mass), self.inertia]))
        return np.sqrt(np.maximum(np.linalg.eigvalsh(root[:, None] * stiffness * root), 0))

    def felt_masses(self):
        """[kg] The mass that a push at the corner where the body gives way most would feel, shared
        by area: contact that is stable for free nodes of these masses is so for the body."""
        share = np.bincount(self.quad.ravel(), minlength=len(self.x0)) / self.quad.size
        least = self.mass
        for arm in self.arms:
            a = cross_matrix(arm)
            least = min(least, 1 / np.linalg.eigvalsh(np.eye(3) / self.mass
                                                      - a @ np.diag(1 / self.inertia) @ a)[-1])
        return least * share

    def stable_step(self, contact_share):
        if self.omega[-1] == 0:
            return LARGEST_STEP
        # Damping in proportion to stiffness acts on the lagged velocity: explicit, so it costs step.
        zeta = 0.5 * self.omega[-1] * max(np.divide(self.c, self.k, where=self.k > 0,
                                                    out=np.zeros(6)))
        return min(stable_factor(contact_share) * 2 / self.omega[-1]
                   * (np.sqrt(1 + zeta**2) - zeta), LARGEST_STEP)

    def turning(self, turn, momentum):
        """[1/s] angular velocity."""
        return turn @ ((turn.T @ momentum) / self.inertia)

    def base_motion(self):
        """Displacement and rotation vector at t, and their rates at t - dt/2."""
        arm, omega = self.turn @ self.arm, self.turning(self.turn, self.momentum)
        place = np.concatenate([self.u + arm - self.arm, rotation_vector(self.turn)])
        return place, np.concatenate([self.v + np.cross(omega, arm), omega]), arm

    def step(self, f, dt):
        place, rate, arm = self.base_motion()
        held = -self.k * place - self.c * rate                                   # springs and dampers
        force = f.sum(axis=0)
        arms = self.arms @ self.turn.T
        moment = np.cross(arms, f).sum(axis=0)
        self.shown = np.concatenate([place, force])
        self.peak = np.maximum(self.peak, np.abs(place))
        self.force_max = max(self.force_max, float(np.linalg.norm(force)))
        self.impulse = self.impulse + force * dt

        kick = 0.5 * (self.last_dt + dt)
        v, momentum = self.v, self.momentum
        omega = self.turning(self.turn, momentum)
        self.v = v + kick * (force + self.weight + held[:3]) / self.mass
        self.momentum = momentum + kick * (moment + np.cross(arm, held[:3]) + held[3:])
        self.book(v, omega, momentum, place, rate, np.concatenate([force + self.weight, moment]))
        self.u = self.u + dt * self.v
        half = rotation(0.5 * dt * self.turning(self.turn, self.momentum)) @ self.turn
        self.turn = rotation(dt * self.turning(half, self.momentum)) @ self.turn
        self.last_dt = dt
        if not (np.isfinite(self.u).all() and np.isfinite(self.turn).all()):
            raise ArithmeticError(f"the body's place is no number after a force of {force} N")

    def book(self, v, omega, momentum, place, rate, loads):
        """Energies at t. Work and damping: mean of the loads at both ends of a step times the way."""
        after = self.turning(self.turn, self.momentum)
        self.kinetic = 0.5 * (self.mass * v @ self.v
                              + 0.5 * (omega @ self.momentum + after @ momentum))
        self.internal = 0.5 * float((self.k * place**2).sum())
        loss = float((self.c * rate**2).sum())
        if self.last is not None:
            self.work += 0.5 * float((self.last + loads) @ np.concatenate([v, omega])) * self.last_dt
            self.damping += loss * self.last_dt
        self.last = loads

    def positions(self):
        return self.center + self.u + self.arms @ self.turn.T

    def velocities(self):
        return self.v + np.cross(self.turning(self.turn, self.momentum), self.arms @ self.turn.T)

    def energies(self):
        error = self.kinetic + self.internal + self.damping - self.work
        return self.kinetic, self.internal, self.damping, self.work, error

    def motion(self):
        return self.shown

    def summary(self):
        return {"frequencies": list(self.omega / 2 / np.pi),
                "max_displacement": float(self.peak[:3].max()), "max_rotation": float(self.peak[3:].max()),
                "force_max": self.force_max, "impulse": list(self.impulse)}


if __name__ == "__main__":
    sys.exit(main("rigid_body", "rigid_body 0.1.0", "A rigid block on soil springs", RigidBody))
