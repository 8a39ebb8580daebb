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
import argparse
import json
import logging
import os
import pathlib
import signal
import sys
import time
import tomllib

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from undertow_protocol import STATE_STOP, Participant, PeerError  # noqa: E402

SOFTWARE = "spring_wall 0.1.0"
LARGEST_STEP = 1e-3      # [s] a slow wall must not carry the fluid over its own scales
DONE, INPUT, PEER, PHYSICS, INTERRUPTED = 0, 2, 3, 4, 130      # exit codes
log = logging.getLogger("spring_wall")


class InputError(Exception):
    pass


# ---------------------------------------------------------------- the case

def merge(base, layer):
    for key, value in layer.items():
        if isinstance(value, dict) and isinstance(base.get(key), dict):
            merge(base[key], value)
        else:
            base[key] = value


def read_case(path, level, variants, overrides):
    """The tables of this program with the level, the variants and the overrides laid over them:
    [backend.spring_wall], and history_every [s] of [output] (0: 1/2000 of the run)."""
    path = pathlib.Path(path)
    path = path / "case.toml" if path.is_dir() else path
    try:
        case = tomllib.loads(path.read_text(encoding="utf-8"))
        layers = [case["level"][level]] if level else []
        layers += [case["variant"][name] for name in variants]
        for assignment in overrides:
            layers.append(tomllib.loads(assignment))
    except OSError as error:
        raise InputError(f"cannot read the case: {error}") from None
    except KeyError as error:
        raise InputError(f"{path}: there is no level or variant {error}") from None
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: {error}") from None
    tables = {key: dict(case.get(key, {})) for key in ("backend", "output")}
    for layer in layers:
        merge(tables, {key: layer[key] for key in tables if key in layer})
    if "spring_wall" not in tables["backend"]:
        raise InputError(f"{path}: the table [backend.spring_wall] is missing")
    return tables["backend"]["spring_wall"], float(tables["output"].get("history_every", 0))


class SpringWall:
    """m q'' + c q' + k q = F_n, q along the normal; every node moves alike."""

    def __init__(self, table):
        table = dict(table)
        try:
            origin, u, v = (np.array(table.pop(key), float) for key in ("origin", "u", "v"))
            n_u, n_v = table.pop("divisions")
            self.mass, self.stiffness = float(table.pop("mass")), float(table.pop("stiffness"))
        except (KeyError, ValueError, TypeError) as error:
            raise InputError("[backend.spring_wall] needs origin, u, v (3 numbers each), divisions "
                             f"(2), mass and stiffness: {error!r}") from None
        ratio = float(table.pop("damping_ratio", 0.0))
        self.surface = table.pop("surface", "wall")
        if table:
            raise InputError(f"[backend.spring_wall] has the unknown key {', '.join(table)}")
        normal = np.cross(u, v)
        if not (self.mass > 0 and self.stiffness >= 0 and ratio >= 0 and n_u > 0 and n_v > 0
                and np.linalg.norm(normal) > 0):
            raise InputError("[backend.spring_wall]: mass and divisions must be > 0, stiffness and "
                             "damping_ratio >= 0, u and v not parallel")
        self.normal = normal / np.linalg.norm(normal)
        self.damping = 2 * ratio * np.sqrt(self.stiffness * self.mass)      # [N s/m]
        self.build_mesh(origin, u, v, n_u, n_v)
        self.q = self.q_dot = 0.0        # [m] at t, [m/s] at t - dt/2
        self.last_dt = 0.0               # [s] 0: the first kick is half a step
        self.last_loads = None           # [N] force and drag at the step before
        self.kinetic = self.spring = self.damped = self.work = 0.0      # [J] at t

    def build_mesh(self, origin, u, v, n_u, n_v):
        a, b = np.meshgrid(np.linspace(0, 1, n_u + 1), np.linspace(0, 1, n_v + 1), indexing="ij")
        self.x0 = origin + a.reshape(-1, 1) * u + b.reshape(-1, 1) * v
        corner = (np.arange(n_u)[:, None] * (n_v + 1) + np.arange(n_v)).ravel()
        self.quad = np.stack([corner, corner + n_v + 1, corner + n_v + 2, corner + 1], axis=1)
        share = np.bincount(self.quad.ravel(), minlength=len(self.x0)) / (4 * n_u * n_v)
        self.nodal_mass = self.mass * share      # by tributary area

    def stable_step(self, contact_share):
        """0.9 of 2/omega, less where contact takes its share: lambda^2 <= 1 - share/4."""
        if self.stiffness == 0:
            return LARGEST_STEP
        limit = min(0.9, np.sqrt(max(1 - contact_share / 4, 0.01)))
        return min(limit * 2 / np.sqrt(self.stiffness / self.mass), LARGEST_STEP)

    def step(self, force, dt):
        """Leapfrog; the damper acts on the mean of the old and the new speed, so that it does not
        lower the stable step."""
        kick = 0.5 * (self.last_dt + dt)
        drag = 0.5 * kick * self.damping / self.mass
        before = self.q_dot
        self.q_dot = ((1 - drag) * before
                      + kick * (force - self.stiffness * self.q) / self.mass) / (1 + drag)
        self.account(before, np.array([force, self.damping * 0.5 * (before + self.q_dot)]))
        self.q += dt * self.q_dot
        self.last_dt = dt
        if not np.isfinite(self.q):
            raise ArithmeticError(f"the wall's displacement is {self.q} after a force of {force} N")

    def account(self, before, loads):
        """Energies at t. Work is the mean of the loads at both ends of a step times its way: then
        the sum balances to round-off while dt does not change, but for the first half kick."""
        self.kinetic = 0.5 * self.mass * before * self.q_dot
        self.spring = 0.5 * self.stiffness * self.q ** 2
        if self.last_loads is not None:
            way = self.last_dt * before
            self.work += 0.5 * (self.last_loads[0] + loads[0]) * way
            self.damped += 0.5 * (self.last_loads[1] + loads[1]) * way
        self.last_loads = loads

    def energies(self):
        """[J] kinetic, spring, damping, contact work, balance error."""
        error = self.kinetic + self.spring + self.damped - self.work
        return self.kinetic, self.spring, self.damped, self.work, error

    def positions(self):
        return self.x0 + self.q * self.normal

    def velocities(self):
        return np.tile(self.q_dot * self.normal, (len(self.x0), 1))


# ---------------------------------------------------------------- the run

class Histories:
    """fem.history.csv and energy.fem.csv, a row every `every` seconds."""

    def __init__(self, out, every):
        self.every, self.next = every, 0
        self.motion = open(out / "fem.history.csv", "w", encoding="ascii", buffering=1)
        self.energy = open(out / "energy.fem.csv", "w", encoding="ascii", buffering=1)
        self.motion.write("# wall: displacement and speed along its normal, contact force on it\n"
                          "# displacement and force at t, speed half a step before\n"
                          "t [s],displacement [m],velocity [m/s],force [N]\n")
        self.energy.write("# energies of the wall at t; internal is the spring's\n"
                          "t [s],kinetic [J],internal [J],damping [J],contact work [J],"
                          "balance error [J]\n")

    def row(self, t, motion, energies):
        if t >= self.next * self.every * (1 - 1e-12):
            self.next = int(t / self.every * (1 + 1e-12)) + 1
            self.motion.write(",".join(f"{value:.9g}" for value in (t, *motion)) + "\n")
            self.energy.write(",".join(f"{value:.9g}" for value in (t, *energies)) + "\n")

    def close(self):
        self.motion.close()
        self.energy.close()


def run(wall, link, out, history_every, stop):
    """All steps; returns the figures of the summary."""
    link.announce(mesh=wall.surface, groups=[wall.surface], x=wall.x0, mass=wall.nodal_mass,
                  quad=wall.quad, group=np.zeros(len(wall.quad)))
    t0, n0, t_end = (link.welcome[key] for key in ("t0", "n0", "te"))
    dt_limit = wall.stable_step(link.welcome["share"])
    histories = Histories(out, history_every or (t_end - t0) / 2000)
    start, t, n, dt_min = time.monotonic(), t0, n0, np.inf
    displacements, force_max, impulse, largest_energy, worst_balance = [0.0, 0.0], 0.0, 0.0, 0.0, 0.0
    while True:
        link.send_state(n, t, dt_limit, wall.positions(), wall.velocities(), "spring of the wall",
                        STATE_STOP if stop else 0, work=float((n - n0) * len(wall.quad)))
        reply = link.wait_reply()
        if reply.finish:
            break
        if reply.checkpoint:
            raise InputError("spring_wall does not write checkpoints")
        dt = reply.force["dt"]
        force = float((reply.force["f"] @ wall.normal).sum())       # [N] along the normal
        motion = (wall.q, wall.q_dot, force)
        wall.step(force, dt)
        energies = wall.energies()
        histories.row(t, motion, energies)
        displacements = [min(displacements[0], wall.q), max(displacements[1], wall.q)]
        force_max, impulse = max(force_max, abs(force)), impulse + force * dt
        largest_energy = max(largest_energy, abs(energies[0]), energies[1], abs(energies[3]))
        worst_balance, dt_min = max(worst_balance, abs(energies[4])), min(dt_min, dt)
        t, n = reply.force["t1"], n + 1
    histories.close()
    link.say_goodbye(n)
    return {"program": SOFTWARE, "complete": reply.finish["reason"] == "done", "t": t,
            "steps": n - n0, "elements": len(wall.quad), "nodes": len(wall.x0),
            "wall_s": time.monotonic() - start, "wait_s": link.waited,
            "dt_min": dt_min if n > n0 else 0.0, "dt_mean": (t - t0) / max(n - n0, 1),
            "energy_balance_error": worst_balance / largest_energy if largest_energy else 0.0,
            "max_displacement": max(displacements[1], -displacements[0]),
            "displacement_min": displacements[0], "displacement_max": displacements[1],
            "force_max": force_max, "impulse": impulse}


def arguments():
    parser = argparse.ArgumentParser(description="A rigid wall on a spring and a damper, in place "
                                                 "of fem_solver. Reads [backend.spring_wall].")
    parser.add_argument("case", metavar="CASE", help="a .toml file or a folder with case.toml")
    parser.add_argument("--out", required=True, metavar="DIR", help="folder of the results")
    parser.add_argument("--coupler", required=True, metavar="ENDPOINT", help="where it listens")
    parser.add_argument("--level", help="level of detail of the case")
    parser.add_argument("--with", dest="variants", action="append", default=[], metavar="VARIANT")
    parser.add_argument("--set", dest="overrides", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--threads", type=int, help="accepted like fem_solver's; this one has one")
    parser.add_argument("--quiet", action="store_true", help="accepted like fem_solver's; the terminal shows errors only")
    parser.add_argument("--version", action="version", version=SOFTWARE)
    return parser.parse_args()


def main():
    options = arguments()
    out = pathlib.Path(options.out)
    stop = []

    def on_signal(*_):
        if stop:
            os._exit(INTERRUPTED)
        stop.append(True)       # the coupler learns it with the next STATE and ends the run

    signal.signal(signal.SIGINT, on_signal)
    signal.signal(signal.SIGTERM, on_signal)
    link = None
    try:
        out.mkdir(parents=True, exist_ok=True)
        logging.basicConfig(level=logging.INFO, filename=out / "fem_solver.log", filemode="w",
                            format="%(asctime)s %(levelname)s %(message)s")
        table, history_every = read_case(options.case, options.level, options.variants,
                                         options.overrides)
        wall = SpringWall(table)
        log.info("%s: %d facets, %g kg, %g N/m", SOFTWARE, len(wall.quad), wall.mass,
                 wall.stiffness)
        link = Participant(options.coupler, "fem", "surface", SOFTWARE)
        summary = run(wall, link, out, history_every, stop)
        aside = out / "summary.fem.json.part"
        aside.write_text(json.dumps(summary, indent=2) + "\n", encoding="ascii")
        aside.replace(out / "summary.fem.json")
        log.info("%s after %d steps", "done" if summary["complete"] else "interrupted",
                 summary["steps"])
        return DONE if summary["complete"] else INTERRUPTED
    except (InputError, OSError, ValueError) as error:
        return fail(link, "E_INPUT", error, INPUT)
    except PeerError as error:
        return fail(link, error.code, error, PEER)
    except ArithmeticError as error:
        return fail(link, "E_PHYSICS", error, PHYSICS)


def fail(link, code, error, exit_code):
    log.error("%s: %s", code, error)
    print(f"spring_wall: {error}", file=sys.stderr)
    if link:
        link.report_error(code, str(error))
    return exit_code


if __name__ == "__main__":
    sys.exit(main())
