"""Runs that are cut and resumed, and whether they leave what the whole run left, byte for byte.

    whole = self.new("structure.toml", "--with", "shells").go()
    cut = self.new("structure.toml", "--with", "shells").go("--set", "checkpoint.every=1e-3")
    cut.resume(cut.sets()[1], threads=2)
    whole.must_equal(cut)
"""
import csv
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import h5py
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
TOP = HERE.parents[1]
BUILD = pathlib.Path(os.environ.get("UNDERTOW_BUILD", TOP / "build")).resolve()
ENVIRONMENT = {**os.environ, "OMP_WAIT_POLICY": "passive", "GOMP_SPINCOUNT": "0",
               "PYTHONDONTWRITEBYTECODE": "1", "UNDERTOW_BUILD": str(BUILD)}


def poor_disk(which, slow=0, room=None):
    """Environment in which writes to files whose path holds `which` take `slow` seconds longer, or find
    `room` bytes for each file."""
    return {"LD_PRELOAD": str(BUILD / "lib" / "libpoor_disk.so"), "UNDERTOW_POOR_DISK": which,
            "UNDERTOW_DISK_SLOW": str(slow), **({} if room is None else {"UNDERTOW_DISK_FULL": str(room)})}


def slow_fields(program):
    """Environment in which a run lasts for seconds on any machine, so that something can be done to it: an
    output is some fifty writes, each 5 ms longer."""
    return poor_disk(f"/{program}.vtkhdf", slow=0.005)


class Restart(unittest.TestCase):
    """Tests of one program (`program`) alone."""

    def new(self, case, *options):
        run = Run(case, *options, program=self.program)
        self.addCleanup(run.folder.cleanup)
        return run

    def check(self, case, *options, every, more_threads=2):
        """The whole run, the same with checkpoints, and that one resumed from two of them. Returns
        the whole run."""
        whole = self.new(case, *options).go()
        cut = self.new(case, *options).go("--set", f"checkpoint.every={every}",
                                          "--set", "checkpoint.keep=100")
        with self.subTest("checkpoints change nothing"):
            whole.must_equal(cut)
        sets = cut.sets()
        self.assertGreater(len(sets), 3)
        for k, threads in ((len(sets) // 2, more_threads), (0, 1)):
            cut.resume(sets[k], threads=threads)
            with self.subTest(resumed=sets[k].name, threads=threads):
                whole.must_equal(cut)
        return whole


    def tool_command(self, *arguments):
        return ["/usr/bin/python3", str(TOP / "scripts" / "undertow"), *map(str, arguments), "--quiet"]

    def tool(self, *arguments, code=0):
        """scripts/undertow; returns what it said."""
        done = subprocess.run(self.tool_command(*arguments), env=ENVIRONMENT, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.assertEqual(done.returncode, code, done.stdout)
        return done.stdout


class Run:
    """One program alone (`program`), with a results folder of its own."""

    def __init__(self, case, *options, program):
        self.case, self.options, self.program = HERE / case, options, program
        self.folder = tempfile.TemporaryDirectory(prefix="undertow-")
        self.out = pathlib.Path(self.folder.name) / "results"

    def command(self, *options, threads=1):
        return [str(BUILD / "bin" / self.program), str(self.case), "--alone", "--quiet", "--out",
                str(self.out), "--threads", str(threads), *self.options, *options]

    def go(self, *options, threads=1, code=0, before=None, environment=()):
        done = subprocess.run(self.command(*options, threads=threads),
                              env={**ENVIRONMENT, **dict(environment)}, text=True,
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, preexec_fn=before)
        self.said = done.stderr
        assert done.returncode == code, f"ended with {done.returncode}, not {code}:\n{done.stderr}"
        return self

    def resume(self, folder, *options, **how):
        return self.go(*options, "--resume", str(folder), **how)

    def sets(self):
        """Folders of whole sets, the oldest first."""
        return sorted(path.parent for path in self.out.glob("checkpoints/*/manifest.json"))

    def column(self, file, name):
        """Values of a history's column whose heading starts with `name`."""
        rows = csv.reader(line for line in (self.out / file).read_text().splitlines()
                          if not line.startswith("#"))
        heading = next(rows)
        at = next(k for k, text in enumerate(heading) if text.startswith(name))
        return [float(row[at]) for row in rows]

    def must_equal(self, other):
        differences = list(compare(self.out, other.out))
        assert not differences, "\n".join(differences[:12])


def compare(a, b):
    """What differs between two results folders, as sentences. Wall times may, and logs."""
    names = lambda folder: {path.name for path in folder.iterdir()
                            if path.suffix in (".csv", ".xdmf", ".vtkhdf", ".json")
                            and not path.name.startswith("status")}
    if names(a) != names(b):
        yield f"files {names(a) ^ names(b)} are in one folder only"
    for name in sorted(names(a) & names(b)):
        if name.endswith(".vtkhdf"):
            yield from compare_fields(a / name, b / name)
        elif name.endswith(".json"):
            if name.startswith("summary."):
                yield from compare_summaries(a / name, b / name)
        elif (a / name).read_bytes() != (b / name).read_bytes():
            yield f"{name}: {first_difference(a / name, b / name)}"


def first_difference(a, b):
    one, two = a.read_text().splitlines(), b.read_text().splitlines()
    for k, (x, y) in enumerate(zip(one, two)):
        if x != y:
            return f"line {k + 1} of {len(one)}: {x[:200]} | {y[:200]}"
    return f"{len(one)} and {len(two)} lines"


def compare_fields(a, b):
    def datasets(file):
        found = {}
        file.visititems(lambda name, item: found.__setitem__(name, item))
        return found
    with h5py.File(a, "r") as one, h5py.File(b, "r") as two:
        x, y = datasets(one), datasets(two)
        if x.keys() != y.keys():
            yield f"{a.name}: {sorted(x.keys() ^ y.keys())[:4]} are in one file only"
        for name in sorted(x.keys() & y.keys()):
            if {k: str(v) for k, v in x[name].attrs.items()} != {k: str(v) for k, v in
                                                                 y[name].attrs.items()}:
                yield f"{a.name}: attributes of {name}"
            if isinstance(x[name], h5py.Dataset):
                p, q = x[name][()], y[name][()]
                if p.shape != q.shape:
                    yield f"{a.name}: {name} has shape {p.shape} | {q.shape}"
                elif p.tobytes() != q.tobytes():
                    rows = np.flatnonzero((p != q).reshape(len(p), -1).any(axis=1))
                    yield (f"{a.name}: {name} differs in {len(rows)} of {len(p)} rows, first "
                           f"{rows[:1]}: {p[rows[0]] if len(rows) else ''} | "
                           f"{q[rows[0]] if len(rows) else ''}")


def is_of_the_machine(key):
    """Times, rates, memory and threads depend on the machine; checkpoints are those of one run."""
    return key == "set" or key.endswith(("_s", "per_s", "_mb", "_mib")) or any(
        part in key for part in ("wall", "wait", "phase", "thread", "checkpoint", "share", "memory",
                                 "fraction", "overhead", "us_per", "bytes"))


def flat(value, path=""):
    if not isinstance(value, dict):
        return {path: value}
    return {k: v for key, part in value.items()
            for k, v in flat(part, f"{path}.{key}" if path else key).items()}


def compare_summaries(a, b):
    x, y = (flat(json.loads(path.read_text())) for path in (a, b))
    for key in sorted(x.keys() | y.keys()):
        if not is_of_the_machine(key) and x.get(key) != y.get(key):
            yield f"{a.name}: {key} is {x.get(key)} | {y.get(key)}"
