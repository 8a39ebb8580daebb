"""undertow pareto: what a ladder file may say, how errors are measured, and a ladder run to its page."""
import contextlib
import io
import json
import pathlib
import sys
import tempfile
import unittest

import numpy as np

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "scripts"))

from undertow_tool.commands import main  # noqa: E402
from undertow_tool.errors import UserError  # noqa: E402
from undertow_tool.pareto.ladder import Curve, ladder_from, ladder_names, read_ladder  # noqa: E402
from undertow_tool.pareto.measure import best_of, curve_error, smoothed  # noqa: E402

CASE = """
[case]
name = "falling"
gravity = [0, 0, -10]
[time]
end = 0.05
[output]
history_every = 1e-4
[fem.block]
box = { min = [0, 0, 0], max = [1, 1, 1] }
divisions = [2, 2, 2]
[[fem.material]]
name = "soft"
density = 1000
young_modulus = 1e9
poisson_ratio = 0.3
[[fem.part]]
set = "block"
material = "soft"
[[fem.probe]]
name = "top"
point = [0.5, 0.5, 1]
[variant.heavy]
case.gravity = [0, 0, -11]
"""

LADDER = """
title = "Two weights"
reference = "light"
[[run]]
name = "light"
[[run]]
name = "heavy"
with = ["heavy"]
[[run]]
name = "light, small steps"
set = ["fem.cfl=0.3"]
[[curve]]
name = "velocity"
file = "fem.history.csv"
column = ["nothing", "top.vz"]
"""


def history(folder, name, t, values):
    (folder / name).write_text("# made up\nt [s],f [N]\n" + "".join(f"{a},{b}\n" for a, b in zip(t, values)))


class Files(unittest.TestCase):
    def refused(self, table, words):
        with self.assertRaises(UserError) as caught:
            ladder_from(table, "x", "x.toml")
        for word in words:
            self.assertIn(word, str(caught.exception))

    def test_what_is_wrong_is_named(self):
        runs, curve = [{"name": "a"}, {"name": "b"}], [{"name": "f", "file": "f.csv", "column": "f"}]
        self.refused({"run": runs, "curve": curve, "referense": "a"}, ["referense", "reference"])
        self.refused({"run": runs, "curve": curve, "reference": "c"}, ["\"c\"", "[[run]]"])
        self.refused({"run": runs}, ["compares nothing"])
        self.refused({"run": [{"name": "a b"}, {"name": "a_b"}], "curve": curve}, ["names differ"])
        self.refused({"run": runs, "reference": "a", "curve": [{**curve[0], "measure": "area"}]}, ["measure", "peak"])
        self.refused({"run": [{"with": []}]}, ["\"name\" is missing"])

    def test_every_ladder_of_the_repository_reads(self):
        found = 0
        for case in sorted((TOP / "cases").glob("*/case.toml")):
            for name in ladder_names(case.parent):
                read_ladder(case.parent, name)
                found += 1
        self.assertGreater(found, 0)


class Errors(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="undertow-test-")
        self.addCleanup(temporary.cleanup)
        self.a, self.b = pathlib.Path(temporary.name, "a"), pathlib.Path(temporary.name, "b")
        self.a.mkdir()
        self.b.mkdir()

    def error(self, **more):
        return curve_error(Curve("f", "f.csv", "f", **more), self.a, self.b)

    def test_of_a_known_pair(self):
        t = np.linspace(0, 1, 4001)
        history(self.a, "f.csv", t, 2 * t + 0.1)
        history(self.b, "f.csv", t[::7], 2 * t[::7])      # written at other times
        self.assertAlmostEqual(self.error(), 0.05, delta=1e-3)
        self.assertAlmostEqual(self.error(measure="peak"), 0.05, delta=1e-3)
        self.assertAlmostEqual(self.error(measure="mean"), 0.10, delta=1e-3)

    def test_noise_shorter_than_the_window_does_not_count(self):
        t = np.linspace(0, 1, 4001)
        history(self.a, "f.csv", t, 1 + np.sin(2 * np.pi * 400 * t))
        history(self.b, "f.csv", t, 1 + 0 * t)
        self.assertGreater(self.error(), 0.5)
        self.assertLess(self.error(window=0.05), 0.01)

    def test_a_run_without_the_history_has_no_error(self):
        history(self.b, "f.csv", [0, 1], [0, 1])
        self.assertIsNone(self.error())

    def test_a_mean_keeps_straight_lines(self):
        t = np.linspace(0, 1, 101)
        _, mean = smoothed(t, 3 * t, 0.1)
        self.assertLess(np.abs(mean - 3 * t)[10:-10].max(), 1e-12)

    def test_best_are_those_that_nobody_beats_twice(self):
        rows = [{"name": n, "cost": {"wall_s": w}, "errors": {"f": e}}
                for n, w, e in (("exact", 100, 0), ("good", 10, 0.1), ("bad", 20, 0.2), ("fast", 1, 0.5), ("mute", 1, None))]
        self.assertEqual(best_of(rows, "f"), {"exact", "good", "fast"})


class Command(unittest.TestCase):
    def test_ladder_to_page(self):
        with tempfile.TemporaryDirectory(prefix="undertow-test-") as temporary:
            case, out = pathlib.Path(temporary, "case"), pathlib.Path(temporary, "out")
            (case / "ladders").mkdir(parents=True)
            (case / "case.toml").write_text(CASE)
            (case / "ladders" / "weight.toml").write_text(LADDER)
            said = io.StringIO()
            with contextlib.redirect_stdout(said):
                code = main(["pareto", str(case), "--out", str(out), "--quiet", "--threads", "1"])
            self.assertEqual(code, 0, said.getvalue())
            light, heavy, small = json.loads((out / "pareto.json").read_text())["runs"]
            self.assertEqual(light["errors"]["velocity"], 0)
            # v = g t: root mean square of 0.1 t over the largest, 1.
            self.assertAlmostEqual(heavy["errors"]["velocity"], 0.1 / 3 ** 0.5, delta=2e-3)
            self.assertLess(small["errors"]["velocity"], 5e-3)
            self.assertGreater(small["cost"]["steps"], 2 * light["cost"]["steps"])
            self.assertGreater(light["cost"]["cpu_s"], 0)
            page = (out / "falling_weight.md").read_text()
            self.assertIn("| heavy |", page)
            self.assertGreater((out / "falling_weight.png").stat().st_size, 10000)
            with contextlib.redirect_stderr(io.StringIO()) as told:
                self.assertEqual(main(["pareto", str(case), "height"]), 2)
            self.assertIn("weight", told.getvalue())


if __name__ == "__main__":
    unittest.main()
