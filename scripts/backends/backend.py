"""What the Python backends have in common: command line, case table, log, histories, summary, and the
loop of steps. A backend is a table of the case and a Structure; spring_wall.py is the shortest one.

A structure has
    surface, x0 (N,3), nodal_mass (N), quad (F,4)    of its one coupled surface [m], [kg]
    limiter                                          what limits its step, for the user
    stable_step(share)      [s] the largest step it can take, see docs/protocol.md
    positions(), velocities()                        (N,3) at t and at t - dt/2
    step(f, dt)             takes a step under the forces f (N,3) [N]; keeps `last_dt` itself
    energies()              [J] at t: kinetic, internal, damping, contact work, balance error
    columns, motion()       names and values of a row of fem.history.csv
    summary()               its own figures of summary.fem.json
    changing                names of the attributes that steps change, for checkpoints.py
"""
import argparse
import json
import logging
import os
import pathlib
import signal
import subprocess
import sys
import time
import tomllib

import checkpoints
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from undertow_protocol import STATE_STOP, Participant, PeerError  # noqa: E402

DONE, INPUT, PEER, PHYSICS, INTERRUPTED = 0, 2, 3, 4, 130      # exit codes


class InputError(Exception):
    pass


# ---------------------------------------------------------------- the case

def merge(base, layer):
    for key, value in layer.items():
        if isinstance(value, dict) and isinstance(base.get(key), dict):
            merge(base[key], value)
        else:
            base[key] = value


def read_case(path, name, level, variants, overrides):
    """[backend.`name`] and history_every [s] of [output] (0: 1/2000 of the run), with the level, the
    variants and the overrides laid over them."""
    path = pathlib.Path(path)
    path = path / "case.toml" if path.is_dir() else path
    try:
        case = tomllib.loads(path.read_text(encoding="utf-8"))
        layers = [case["level"][level]] if level else []
        layers += [case["variant"][variant] for variant in variants]
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
    if name not in tables["backend"]:
        raise InputError(f"{path}: the table [backend.{name}] is missing")
    return tables["backend"][name], float(tables["output"].get("history_every", 0))


def binding_keys(options):
    """What the case must have in common with the coupler's, as undertow_case tells it. () where that program
    is not built, or the case is none for a coupler of ours: then nothing is compared."""
    build = pathlib.Path(os.environ.get("UNDERTOW_BUILD", HERE.parents[1] / "build"))
    tool = pathlib.Path(os.environ.get("UNDERTOW_CASE_TOOL", build / "bin" / "undertow_case"))
    layers = ["--level", options.level] if options.level else []
    layers += [word for variant in options.variants for word in ("--with", variant)]
    layers += [word for assignment in options.overrides for word in ("--set", assignment)]
    if not tool.exists():
        return ()
    done = subprocess.run([tool, options.case, "--binding", *layers], capture_output=True, text=True, check=False)
    return done.stdout.splitlines() if done.returncode == 0 else ()


class Table:
    """Takes the keys out of [backend.NAME] one by one; what is left over is unknown."""

    def __init__(self, name, table):
        self.name, self.left = f"[backend.{name}]", dict(table)

    def number(self, key, default=None, above=None, least=None):
        value = self.take(key, default, "a number")
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not np.isfinite(value):
            self.refuse(key, value, "a number")
        if above is not None and not value > above or least is not None and not value >= least:
            self.refuse(key, value, f"> {above:g}" if above is not None else f">= {least:g}")
        return float(value)

    def numbers(self, key, count, default=None):
        value = self.take(key, default, f"{count} numbers")
        try:
            array = np.array(value, float)
        except (ValueError, TypeError):
            array = np.zeros(0)
        if array.shape != (count,) or not np.isfinite(array).all():
            self.refuse(key, value, f"{count} numbers")
        return array

    def counts(self, key, count):
        value = self.take(key, None, f"{count} whole numbers > 0")
        if not (isinstance(value, list) and len(value) == count
                and all(type(n) is int and n > 0 for n in value)):
            self.refuse(key, value, f"{count} whole numbers > 0")
        return value

    def word(self, key, default, allowed=None):
        value = self.take(key, default, "a text")
        if not isinstance(value, str) or allowed and value not in allowed:
            self.refuse(key, value, "one of " + ", ".join(allowed) if allowed else "a text")
        return value

    def take(self, key, default, kind):
        if key not in self.left and default is None:
            raise InputError(f"{self.name}: the key {key} is missing; it is {kind}")
        return self.left.pop(key, default)

    def refuse(self, key, value, allowed):
        raise InputError(f"{self.name}: {key} = {value} must be {allowed}")

    def end(self):
        if self.left:
            raise InputError(f"{self.name} has the unknown key {', '.join(self.left)}")


# ---------------------------------------------------------------- meshes

def grid(n_u, n_v):
    """Nodes (a, b) of the unit square, and its facets counter-clockwise seen along u x v."""
    a, b = np.meshgrid(np.linspace(0, 1, n_u + 1), np.linspace(0, 1, n_v + 1), indexing="ij")
    corner = (np.arange(n_u)[:, None] * (n_v + 1) + np.arange(n_v)).ravel()
    quad = np.stack([corner, corner + n_v + 1, corner + n_v + 2, corner + 1], axis=1)
    return a.reshape(-1, 1), b.reshape(-1, 1), quad


def stable_factor(contact_share):
    """lambda of lambda * 2/omega: 0.9, less where contact takes its share, lambda^2 <= 1 - 3 share/8."""
    return min(0.9, np.sqrt(max(1 - 3 * contact_share / 8, 0.01)))


class Energies:
    """[J] at t. Work is the mean of the power's loads at both ends of a step times the way; then the
    sum balances to round-off while dt does not change, but for the first half kick."""

    changing = "kinetic", "internal", "damping", "work", "last"

    def __init__(self):
        self.kinetic = self.internal = self.damping = self.work = 0.0
        self.last = None

    def book(self, before, after, mass, internal, force, drag, last_dt):
        """before, after: generalized velocities on both sides of t; mass: their masses; force, drag:
        generalized loads at t."""
        self.kinetic = 0.5 * float((mass * before * after).sum())
        self.internal = internal
        if self.last is not None:
            way = last_dt * before
            self.work += 0.5 * float(((self.last[0] + force) * way).sum())
            self.damping += 0.5 * float(((self.last[1] + drag) * way).sum())
        self.last = np.array(force, float), np.array(drag, float)

    def row(self):
        error = self.kinetic + self.internal + self.damping - self.work
        return self.kinetic, self.internal, self.damping, self.work, error


# ---------------------------------------------------------------- the run

class Histories:
    """fem.history.csv and energy.fem.csv, a row every `every` seconds."""

    changing = "row_t", "sizes"

    def __init__(self, out, every, columns):
        self.every, self.row_t = every, -1.0         # [s] of the last row
        self.paths = out / "fem.history.csv", out / "energy.fem.csv"
        self.columns = columns

    @property
    def sizes(self):
        """[byte] of both files, each row written."""
        return np.array([file.tell() for file in (self.motion, self.energy)])

    @sizes.setter
    def sizes(self, sizes):
        """The files go on behind the rows of the checkpoint."""
        self.motion, self.energy = (self.cut(path, int(size)) for path, size in zip(self.paths, sizes))

    @staticmethod
    def cut(path, size):
        if not path.exists() or path.stat().st_size < size:
            raise InputError(f"{path} is shorter than at the checkpoint or missing; the run cannot go on in it: "
                             "start anew")
        file = open(path, "r+", encoding="ascii", buffering=1)
        file.truncate(size)
        file.seek(size)
        return file

    def start(self):
        self.motion, self.energy = (open(path, "w", encoding="ascii", buffering=1) for path in self.paths)
        self.motion.write("# displacements and forces at t, velocities half a step before\n"
                          + ",".join(("t [s]", *self.columns)) + "\n")
        self.energy.write("# energies of the structure at t; internal is that of its springs\n"
                          "t [s],kinetic [J],internal [J],damping [J],contact work [J],"
                          "balance error [J]\n")

    def row(self, t, motion, energies):
        following = int(self.row_t / self.every * (1 + 1e-12)) + 1 if self.row_t >= 0 else 0
        if t >= following * self.every * (1 - 1e-12):
            self.row_t = t
            self.motion.write(",".join(f"{value:.9g}" for value in (t, *motion)) + "\n")
            self.energy.write(",".join(f"{value:.9g}" for value in (t, *energies)) + "\n")

    def close(self):
        self.motion.close()
        self.energy.close()


class Tally:
    """What the summary says of the whole run, its parts before a resume included."""

    changing = ("n", "t", "n0", "t0", "dt_min", "largest_energy", "worst_balance", "wall_s", "cpu_s", "wait_s")

    def __init__(self):
        self.n = self.n0 = 0
        self.t = self.t0 = 0.0
        self.dt_min, self.largest_energy, self.worst_balance = np.inf, 0.0, 0.0
        self.wall_s = self.cpu_s = self.wait_s = 0.0
        self._clocks = np.array([time.monotonic(), time.process_time(), 0.0])

    def clock(self, waited):
        """Brings the times up to now; waited [s] is that of this part of the run."""
        now = np.array([time.monotonic(), time.process_time(), waited])
        self.wall_s, self.cpu_s, self.wait_s = (now - self._clocks + [self.wall_s, self.cpu_s, self.wait_s]).tolist()
        self._clocks = now

    def count(self, dt, energies):
        self.largest_energy = max(self.largest_energy, abs(energies[0]), energies[1], abs(energies[3]))
        self.worst_balance, self.dt_min = max(self.worst_balance, abs(energies[4])), min(self.dt_min, dt)


def begin(link, structure, histories, tally, keys, resume):
    """The state at the first step: as built, or that of the set `resume`."""
    if not resume:
        histories.start()
        tally.t, tally.n = tally.t0, tally.n0 = link.welcome["t0"], link.welcome["n0"]
        return
    state = checkpoints.read(resume, keys)
    checkpoints.restore_parts(state, tally=tally)
    if (tally.n, tally.t) != (link.welcome["n0"], link.welcome["t0"]):
        raise InputError(f"{resume} is of step {tally.n}, the coupler goes on at step {link.welcome['n0']}: the "
                         "files are of different sets")
    checkpoints.restore_parts(state, structure=structure, histories=histories)      # which cuts what was written since


def take_steps(structure, link, out, history_every, stop, software, keys, resume):
    """All steps; returns the figures of the summary."""
    link.announce(mesh=structure.surface, groups=[structure.surface], x=structure.x0,
                  mass=structure.nodal_mass, quad=structure.quad, group=np.zeros(len(structure.quad)))
    every = history_every or link.welcome["te"] / 2000
    histories, tally = Histories(out, every, structure.columns), Tally()
    parts = {"tally": tally, "structure": structure, "histories": histories}
    begin(link, structure, histories, tally, keys, resume)
    dt_limit = structure.stable_step(link.welcome["share"])
    while True:
        link.send_state(tally.n, tally.t, dt_limit, structure.positions(), structure.velocities(),
                        structure.limiter, STATE_STOP if stop else 0,
                        work=float((tally.n - tally.n0) * len(structure.quad)))
        reply = link.wait_reply()
        while reply.checkpoint:
            tally.clock(link.waited)
            link.send_checkpoint_ack(*checkpoints.write(out, reply.checkpoint["id"], keys, parts))
            reply = link.wait_reply()
        if reply.finish:
            break
        dt = reply.force["dt"]
        structure.step(reply.force["f"], dt)
        energies = structure.energies()
        histories.row(tally.t, structure.motion(), energies)
        tally.count(dt, energies)
        tally.t, tally.n = reply.force["t1"], tally.n + 1
    histories.close()
    link.say_goodbye(tally.n)
    tally.clock(link.waited)
    steps = tally.n - tally.n0
    return {"program": software, "complete": reply.finish["reason"] == "done", "t": tally.t,
            "steps": steps, "elements": len(structure.quad), "nodes": len(structure.x0),
            "wall_s": tally.wall_s, "wait_s": tally.wait_s, "cpu_s": tally.cpu_s,
            "dt_min": tally.dt_min if steps else 0.0, "dt_mean": (tally.t - tally.t0) / max(steps, 1),
            "energy_balance_error": tally.worst_balance / tally.largest_energy if tally.largest_energy else 0.0,
            **structure.summary()}


def arguments(name, software, description):
    parser = argparse.ArgumentParser(description=f"{description}, in place of fem_solver. Reads "
                                                 f"[backend.{name}].")
    parser.add_argument("case", metavar="CASE", help="a .toml file or a folder with case.toml")
    parser.add_argument("--out", required=True, metavar="DIR", help="folder of the results")
    parser.add_argument("--coupler", required=True, metavar="ENDPOINT", help="where it listens")
    parser.add_argument("--keys", metavar="FOLDER", help="keys for a coupler on another host")
    parser.add_argument("--resume", metavar="FOLDER", help="go on from this set: DIR/checkpoints/STEP")
    parser.add_argument("--level", help="level of detail of the case")
    parser.add_argument("--with", dest="variants", action="append", default=[], metavar="VARIANT")
    parser.add_argument("--set", dest="overrides", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--threads", type=int, help="accepted like fem_solver's; this one has one")
    parser.add_argument("--quiet", action="store_true",
                        help="accepted like fem_solver's; the terminal shows errors only")
    parser.add_argument("--version", action="version", version=software)
    return parser.parse_args()


def build(make, table, case):
    """The structure of the table, of which every key is known."""
    try:
        structure = make(table)
        table.end()
    except InputError as error:
        raise InputError(f"{case}: {error}") from None
    return structure


def main(name, software, description, make):
    """The program: make(table) builds the structure from its Table."""
    options = arguments(name, software, description)
    log = logging.getLogger(name)
    out = pathlib.Path(options.out)
    stop = []

    def on_signal(*_):
        if stop:
            os._exit(INTERRUPTED)
        stop.append(True)       # the coupler learns it with the next STATE and ends the run

    def fail(code, error, exit_code):
        log.error("%s: %s", code, error)
        print(f"{name}: {error}", file=sys.stderr)
        if link:
            link.report_error(code, str(error))
        return exit_code

    signal.signal(signal.SIGINT, on_signal)
    signal.signal(signal.SIGTERM, on_signal)
    link = None
    try:
        out.mkdir(parents=True, exist_ok=True)
        logging.basicConfig(level=logging.INFO, filename=out / "fem_solver.log", filemode="a" if options.resume else "w",
                            format="%(asctime)s %(levelname)s %(message)s")
        keys, history_every = read_case(options.case, name, options.level, options.variants,
                                        options.overrides)
        structure = build(make, Table(name, keys), options.case)
        log.info("%s: %d facets, %s", software, len(structure.quad), structure.description)
        link = Participant(options.coupler, "fem", "surface", software, stop=lambda: bool(stop),
                           capabilities=["checkpoint"], keys=options.keys, case_keys=binding_keys(options))
        summary = take_steps(structure, link, out, history_every, stop, software, keys, options.resume)
        aside = out / "summary.fem.json.part"
        aside.write_text(json.dumps(summary, indent=2) + "\n", encoding="ascii")
        aside.replace(out / "summary.fem.json")
        log.info("%s after %d steps", "done" if summary["complete"] else "interrupted",
                 summary["steps"])
        return DONE if summary["complete"] else INTERRUPTED
    except OSError as error:
        return fail("E_IO", error, INPUT)
    except (InputError, checkpoints.CheckpointError, ValueError) as error:
        return fail("E_INPUT", error, INPUT)
    except PeerError as error:
        return fail(error.code, error, INTERRUPTED if error.code == "E_STOP" else PEER)
    except ArithmeticError as error:
        return fail("E_PHYSICS", error, PHYSICS)
