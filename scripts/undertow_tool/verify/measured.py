"""What a verification's report.py works with: the results of one run of the SPH solver alone, and the
rows that compare them with what is exact.

    from undertow_tool.verify.measured import Measured

    def report(results_dir, case, summary):
        run = Measured(results_dir, case, summary)
        run.compare("frequency", fitted_frequency(run), 7.836, "rad/s", "linear theory")
        return run.rows

Gates stand in the case: [report.gates] gives each row's largest error at every level of the ladder. A row
that misses a gate of physics for a known reason is listed in [report.defects] with that reason and with the
error it may have until it is mended.
"""
from pathlib import Path

import numpy as np

from ..checks import check, relative
from ..fields import open_fields
from ..history import read_history


class Measured:
    def __init__(self, results_dir, case, summary):
        self.folder, self.case, self.summary = Path(results_dir), case, summary
        self.settings = case["report"]
        self.sph = summary.get("sph") or {}
        self.dx = case["sph"]["spacing"]
        self.fields = open_fields(self.folder / "sph.vtkhdf")
        self.gravity = np.array(case["case"]["gravity"], dtype=float)
        self.rows = []

    # ---- what was measured
    def history(self, name):
        """The columns of NAME.csv: "gauges", "forces", "energy.sph"."""
        found = read_history(self.folder / f"{name}.csv")
        if found is None:
            raise FileNotFoundError(f"{self.folder / name}.csv is missing: the run wrote no such history")
        return found

    @property
    def times(self):
        """Of the field outputs [s]."""
        return self.fields.times

    def at(self, t, *names):
        """Positions (n, 3) [m] and the named fields at the output nearest to t [s]."""
        return self.fields.read(self.fields.nearest(t), *names)

    def fluid_of(self, step, count):
        """Index of each particle's fluid, 0 where there is only one."""
        index = self.fields.read(step, "fluid")[1]
        return np.zeros(count, dtype=int) if index is None else index.astype(int)

    def masses(self, step, count):
        """Of each particle [kg]."""
        of = [self.sph["fluid"][fluid["name"]]["particle_mass_kg"] for fluid in self.case["sph"]["fluid"]]
        return np.array(of)[self.fluid_of(step, count)]

    def momentum(self):
        """Sum of m v at each output (outputs, 3), and of m |v| (outputs)   [kg m/s]"""
        total, size = [], []
        for step in range(len(self.fields)):
            v = self.fields.read(step, "velocity")[1]
            m = self.masses(step, len(v))
            total.append(m @ v)
            size.append(float(m @ np.linalg.norm(v, axis=1)))
        return np.array(total), np.array(size)

    def momentum_error(self):
        """Largest difference between the fluid's momentum and what gravity and walls gave it, over the
        largest sum of m |v| plus the weight's impulse. Wall forces are integrated over the rows of
        forces.csv, so with walls its interval shows; None where a wall has friction or moves."""
        walls = self.case["sph"]["plane"]
        if any(w["slip"] != "free" for w in walls) or self.case["sph"].get("body"):
            return None
        total, size = self.momentum()
        mass = float(np.sum(self.masses(0, len(self.fields.read(0)[0]))))
        given = np.outer(self.times - self.times[0], mass * self.gravity)
        if walls:
            forces = read_history(self.folder / "forces.csv")
            for axis in range(3):
                acting = sum((forces[c] for c in forces if c.endswith(".f" + "xyz"[axis])), np.zeros(len(forces["t"])))
                steps = 0.5 * (acting[1:] + acting[:-1]) * np.diff(forces["t"])
                # forces.csv has what the fluid does to the walls
                given[:, axis] -= np.interp(self.times, forces["t"], np.concatenate(([0.0], np.cumsum(steps))))
        scale = size.max() + mass * np.linalg.norm(self.gravity) * (self.times[-1] - self.times[0])
        if scale == 0:
            return None
        return float(np.abs(total - total[0] - given).max() / scale)

    # ---- rows of the table
    def gate(self, name):
        """Largest allowed error of a row at this run's level; None when there is none."""
        return self._at_level((self.settings.get("gates") or {}).get(name))

    def _at_level(self, values):
        """One number for all levels, or one for each of the ladder; variants and overrides are not judged."""
        level, ladder = self.summary.get("level", ""), self.settings.get("ladder") or []
        if values is None or not level or self.summary.get("variants") or self.summary.get("set"):
            return None
        if not isinstance(values, list):
            return float(values)
        return float(values[ladder.index(level)]) if level in ladder else None

    def compare(self, name, value, reference, unit="", note=""):
        """Error relative to a reference that is not 0."""
        self._add(relative(name, float(value), float(reference), self.gate(name), unit, note))

    def residual(self, name, value, unit="", note=""):
        """Something that should be 0, made dimensionless by the caller or with its unit."""
        self._add(check(name, float(value), 0.0, float(value), self.gate(name), unit, note))

    def tell(self, name, value, unit="", note=""):
        """A figure without a reference."""
        self._add(check(name, float(value), None, unit=unit, note=note))

    def _add(self, row):
        if row["tolerance"] is not None and row.get("measure") == "relative":
            row["ok"] = bool(row["error"] is not None and abs(row["error"]) <= row["tolerance"])
        known = (self.settings.get("defects") or {}).get(row["name"])
        if known:
            row["defect"] = known["why"]
            at_most = self._at_level(known.get("at_most"))
            row["worse"] = at_most is not None and not (row["error"] is not None and abs(row["error"]) <= at_most)
        self.rows.append(row)
