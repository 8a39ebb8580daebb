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


def read_table(path, level, variants, overrides):
    """[backend.spring_wall] with the level, the variants and the overrides laid over it."""
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
    table = case.get("backend", {}).get("spring_wall")
    if table is None:
        raise InputError(f"{path}: the table [backend.spring_wall] is missing")
    for layer in layers:
        merge(table, layer.get("backend", {}).get("spring_wall", {}))
    return table


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
        self.q_dot = ((1 - drag) * self.q_dot
                      + kick * (force - self.stiffness * self.q) / self.mass) / (1 + drag)
        self.q += dt * self.q_dot
        self.last_dt = dt
        if not np.isfinite(self.q):
            raise ArithmeticError(f"the wall's displacement is {self.q} after a force of {force} N")

    def positions(self):
        return self.x0 + self.q * self.normal

    def velocities(self):
        return np.tile(self.q_dot * self.normal, (len(self.x0), 1))


# ---------------------------------------------------------------- the run

def run(wall, link, history, stop):
    """All steps; returns the figures of the summary."""
    link.announce(mesh=wall.surface, groups=[wall.surface], x=wall.x0, mass=wall.nodal_mass,
                  quad=wall.quad, group=np.zeros(len(wall.quad)))
    dt_limit = wall.stable_step(link.welcome["share"])
    start, t, n = time.monotonic(), link.welcome["t0"], link.welcome["n0"]
    figures = {"displacement_max": 0.0, "displacement_min": 0.0, "impulse": 0.0, "force_max": 0.0}
    dt_min, t0 = np.inf, t
    while True:
        link.send_state(n, t, dt_limit, wall.positions(), wall.velocities(), "spring of the wall",
                        STATE_STOP if stop else 0, work=float(n * len(wall.x0)))
        reply = link.wait_reply()
        if reply.finish:
            break
        if reply.checkpoint:
            raise InputError("spring_wall does not write checkpoints")
        dt = reply.force["dt"]
        force = float((reply.force["f"] @ wall.normal).sum())       # [N] along the normal
        history.write(f"{t:.9g},{wall.q:.9g},{wall.q_dot:.9g},{force:.9g}\n")
        wall.step(force, dt)
        figures["displacement_max"] = max(figures["displacement_max"], wall.q)
        figures["displacement_min"] = min(figures["displacement_min"], wall.q)
        figures["force_max"] = max(figures["force_max"], abs(force))
        figures["impulse"] += force * dt
        dt_min = min(dt_min, dt)
        t, n = reply.force["t1"], n + 1
    link.say_goodbye(n)
    n_steps = n - link.welcome["n0"]
    return {"program": SOFTWARE, "ok": True, "reason": reply.finish["reason"],
            "wall_s": time.monotonic() - start, "steps": n_steps, "t_end": t,
            "dt_min": dt_min if n_steps else 0.0, "dt_mean": (t - t0) / max(n_steps, 1),
            "fem": {"elements": len(wall.quad), "nodes": len(wall.x0), "wait_s": link.waited,
                    **figures}}


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
    parser.add_argument("--quiet", action="store_true", help="nothing on the terminal but errors")
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
        handlers = [logging.FileHandler(out / "fem_solver.log", mode="w")]
        handlers += [] if options.quiet else [logging.StreamHandler(sys.stderr)]
        logging.basicConfig(level=logging.INFO, handlers=handlers,
                            format="%(asctime)s %(levelname)s %(message)s")
        wall = SpringWall(read_table(options.case, options.level, options.variants,
                                     options.overrides))
        log.info("%s: %d facets, %g kg, %g N/m", SOFTWARE, len(wall.quad), wall.mass,
                 wall.stiffness)
        link = Participant(options.coupler, "fem", "surface", SOFTWARE)
        with open(out / "fem.history.csv", "w", encoding="ascii") as history:
            history.write("# wall: displacement and speed along its normal, contact force on it\n"
                          "# displacement and force at t, velocity half a step before\n"
                          "t [s],displacement [m],velocity [m/s],force [N]\n")
            summary = run(wall, link, history, stop)
        aside = out / "summary.fem.json.part"
        aside.write_text(json.dumps(summary, indent=2) + "\n", encoding="ascii")
        aside.replace(out / "summary.fem.json")
        log.info("%s after %d steps", summary["reason"], summary["steps"])
        return INTERRUPTED if summary["reason"] == "interrupted" else DONE
    except (InputError, OSError, ValueError) as error:
        return fail(link, "E_INPUT", error, INPUT)
    except PeerError as error:
        return fail(link, error.code, error, PEER)
    except ArithmeticError as error:
        return fail(link, "E_PHYSICS", error, PHYSICS)


def fail(link, code, error, exit_code):
    log.error("%s: %s", code, error)
    print(f"spring_wall: {error}", file=sys.stderr) if not log.hasHandlers() else None
    if link:
        link.report_error(code, str(error))
    return exit_code


if __name__ == "__main__":
    sys.exit(main())
