"""What the report.py of a verification of the FEM solver alone works with, and what its table shows.

    from undertow_tool.verify.structure import MeasuredStructure

    def report(results_dir, case, summary):
        run = MeasuredStructure(results_dir, case, summary)
        run.compare("deflection", run.mean_of_end("tip.uz"), 21.5, "m", "reference")
        return run.rows
"""
from pathlib import Path

import numpy as np

from ..fields import open_fields
from .measured import Measured


def element_length(case):
    """[m] of the mesh: the mean edge of a block's cells in the directions that have more than one; of a mesh
    file the one that [report] names as lengths.LEVEL."""
    block = case["fem"]["block"]
    if block is None:
        return float(case["report"]["lengths"][case["level"]])
    corners = np.array(block.get("corners") or [], dtype=float)
    if len(corners) == 0:
        extent = np.array(block["box"]["max"], dtype=float) - block["box"]["min"]
    else:       # mean length of the four edges along each direction
        along = ([(0, 1), (3, 2), (4, 5), (7, 6)], [(0, 3), (1, 2), (4, 7), (5, 6)], [(0, 4), (1, 5), (2, 6), (3, 7)])
        extent = np.array([np.mean([np.linalg.norm(corners[b] - corners[a]) for a, b in edges]) for edges in along])
    divisions = np.array(block["divisions"], dtype=float)
    lengths = extent / np.maximum(divisions, 1)       # a sheet of shells has 0 across itself
    if np.any(divisions > 1):
        lengths = lengths[divisions > 1]
    return float(np.mean(lengths))


class MeasuredStructure(Measured):
    def __init__(self, results_dir, case, summary):      # not the SPH solver's: other files, other figures
        self.folder, self.case, self.summary = Path(results_dir), case, summary
        self.settings = case["report"]
        self.fem = summary.get("fem") or {}
        self.dx = element_length({**case, "level": summary.get("level", "")})
        self.fields = open_fields(self.folder / "fem.vtkhdf")
        self.gravity = np.array(case["case"]["gravity"], dtype=float)
        self.rows = []

    def probe(self, column):
        """(t [s], values) of a column of fem.history.csv: "tip.uz"."""
        history = self.history("fem.history")
        return history["t"], history[column]

    def mean_of_end(self, column, share=0.1):
        """Mean over the last `share` of the run."""
        t, values = self.probe(column)
        return float(np.mean(values[t >= t[-1] - share * (t[-1] - t[0])]))

    def unrest(self, column, share=0.1):
        """What still moves over the last `share` of the run, relative to its mean there."""
        t, values = self.probe(column)
        end = values[t >= t[-1] - share * (t[-1] - t[0])]
        return float((end.max() - end.min()) / abs(np.mean(end)))


def figures_of_structure(out, case, summary):
    """What the table and the pictures need of one run."""
    fem, cost = summary["fem"], summary["cost"]
    steps = summary["steps"] * fem["elements"]
    return {"spacing": MeasuredStructure(out, case, summary).dx, "elements": fem["elements"], "steps": summary["steps"],
            "dt_mean": summary["dt_mean"], **cost, "element_steps_per_cpu_s": steps / max(cost["cpu_s"], 1e-9),
            "energy_balance_error": fem.get("energy_balance_error"), "checks": summary["checks"]}
