"""The verification ladder: how rows are judged, how an order is found, and that a missed gate fails the command."""
import contextlib
import io
import json
import pathlib
import shutil
import sys
import tempfile
import unittest
import unittest.mock

import h5py
import numpy as np

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "scripts"))

from undertow_tool.commands import main  # noqa: E402
from undertow_tool.paths import BUILD  # noqa: E402
from undertow_tool.verify.closing_table import closing_rows  # noqa: E402
from undertow_tool.verify.ladder import Rung  # noqa: E402
from undertow_tool.verify.measured import Measured  # noqa: E402
from undertow_tool.verify.order import observed_order  # noqa: E402
from undertow_tool.verify.pages import BEGIN, END, row_state, write_page  # noqa: E402

CASE = {"case": {"gravity": [0, 0, 0]}, "sph": {"spacing": 0.1, "plane": [], "plate": [], "fluid": [{"name": "water"}]},
        "report": {"ladder": ["coarse", "fine"], "gates": {"speed": [0.2, 0.1], "drift": 0.1},
                   "defects": {"drift": {"why": "it drifts", "at_most": [0.5, 0.3]}}}}


def measured(folder, level="fine", **summary):
    return Measured(folder, CASE, {"level": level, "sph": {"fluid": {"water": {"particle_mass_kg": 2.0}}}, **summary})


def states(run):
    return [row_state(row) for row in run.rows]


class Pages(unittest.TestCase):
    def test_tables_of_other_verifications_stay(self):
        folder = pathlib.Path(tempfile.mkdtemp(prefix="undertow-test-"))
        self.addCleanup(shutil.rmtree, folder)
        page = folder / "page.md"
        kept = "### heap: a heap\n\nkept word for word\n\n| a |\n|---|"
        page.write_text(f"Before.\n\n{BEGIN}\n\n{kept}\n\n### couette: old\n\nold table\n\n### no_such_case: x\n\ny\n\n{END}\nAfter.\n")
        (folder / "couette.png").write_bytes(b"")
        result = {"name": "couette", "title": "new", "exact": "zero", "gates_from": "guess", "defects": {}, "orders": {}, "rungs": [],
                  "failed_runs": [], "set": [], "made": {}, "solver": "page_test"}
        images = TOP / "docs" / "images" / "verify_page_test"
        self.addCleanup(shutil.rmtree, images, ignore_errors=True)
        with unittest.mock.patch.dict("undertow_tool.verify.pages.COLUMNS", {"page_test": ()}):
            for _ in range(2):      # the second writing changes nothing
                write_page(page, [(folder / "couette.json", result)])
                text = page.read_text()
                self.assertIn(kept, text)
                self.assertIn("### couette: new", text)
                self.assertNotIn("old", text)
                self.assertNotIn("no_such_case", text)
                self.assertLess(text.index("couette"), text.index("heap"))
                self.assertTrue(text.startswith("Before.") and text.endswith("After.\n"))
        self.assertEqual(text.count("\n\n\n"), 0)


class ClosingTable(unittest.TestCase):
    SECTION = ["### wave: A wave", "", "| level | dx [m] | CPU [s] | M particle-steps/CPU s | quantity | ours | error | allowed | |",
               "|---|---|---|---|---|---|---|---|---|",
               "| coarse | 0.2 | 1.0 | 5.0 | speed | 1.04 m/s | +4.0 % | 5 % | ok |", "|  |  |  |  | drift of \\|v\\| | 0.5 | 0.5 | 0.1 | defect |",
               "| fine | 0.1 | 8.0 | 6.0 | speed | 0.99 m/s | -1.0 % | 2 % | ok |", "|  |  |  |  | drift of \\|v\\| | 0.05 | 0.05 | 0.1 | mended |",
               "| fine plain | 0.1 | 8.0 | 6.0 | speed | 0.5 m/s | -50.0 % | - | - |",
               "| soak | 0.2 | 90.0 | 5.0 | speed | 1.03 m/s | +3.0 % | 5 % | ok |"]

    def test_a_line_has_errors_order_and_cost_of_the_ladder(self):
        report = {"ladder": ["coarse", "fine"], "converges": ["speed"], "headline": ["speed", "drift of |v|"]}
        self.assertEqual(closing_rows("wave", self.SECTION, report), [
            "| [wave](#wave-a-wave) | 0.2, 0.1 | speed | +4.0, -1.0 %; soak +3.0 % | 2.0 | 2 % | ok | 1.0, 8.0 | 6.0 |",
            "|  |  | drift of \\|v\\| | 0.5, 0.05 | - | 0.1 | defect (coarse) |  |  |"])

    def test_an_error_of_zero_has_no_order(self):
        section = [line.replace("+4.0 %", "+0.0 %") for line in self.SECTION]
        rows = closing_rows("wave", section, {"ladder": ["coarse", "fine"], "converges": ["speed"]})
        self.assertEqual([row.split(" | ")[4] for row in rows], ["-"])


class Judging(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="undertow-test-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def test_a_gate_belongs_to_its_level(self):
        for level, state in (("coarse", "ok"), ("fine", "FAILS")):
            run = measured(self.folder, level)
            run.compare("speed", 1.15, 1.0)
            self.assertEqual(states(run), [state])

    def test_an_error_of_either_sign_counts(self):
        run = measured(self.folder)
        run.compare("speed", 0.85, 1.0)
        run.residual("speed", -0.15)
        self.assertEqual(states(run), ["FAILS", "FAILS"])

    def test_a_value_that_is_not_finite_fails(self):
        run = measured(self.folder)
        run.compare("speed", float("nan"), 1.0)
        run.residual("drift", float("nan"))
        self.assertEqual(states(run), ["FAILS", "FAILS"])

    def test_a_known_defect_may_not_grow(self):
        run = measured(self.folder)
        for value in (0.05, 0.25, 0.35):
            run.residual("drift", value)
        self.assertEqual(states(run), ["mended", "defect", "FAILS"])

    def test_variants_and_overrides_are_not_judged(self):
        for what in ({"variants": ["wider"]}, {"set": ["sph.cfl=1"]}):
            run = measured(self.folder, **what)
            run.compare("speed", 5.0, 1.0)
            self.assertEqual(states(run), ["-"])

    def test_momentum_that_nobody_gave_is_an_error(self):
        with h5py.File(self.folder / "sph.vtkhdf", "w") as file:
            file["VTKHDF/Steps/Values"] = [0.0, 1.0]
            for step, speed in enumerate((1.0, 1.25)):
                file[f"Views/{step:05d}/Points"] = np.zeros((2, 3))
                file[f"Views/{step:05d}/PointData/velocity"] = [[speed, 0, 0], [0, 0, 0]]
        # 2 kg x 0.25 m/s over the largest sum of m |v|, 2 kg x 1.25 m/s
        self.assertAlmostEqual(measured(self.folder).momentum_error(), 0.2)

    def test_the_observed_order_is_the_slope_of_the_errors(self):
        rungs = [Rung("a", "", {"spacing": dx, "checks": [{"name": "e", "error": -3 * dx**2}]}) for dx in (0.1, 0.05, 0.025)]
        rungs.append(Rung("b", "variant", {"spacing": 0.05, "checks": [{"name": "e", "error": 9.0}]}))
        self.assertAlmostEqual(observed_order(rungs, "e"), 2.0)
        self.assertIsNone(observed_order(rungs[:1], "e"))


@unittest.skipUnless((BUILD / "bin" / "sph_solver").exists(), "sph_solver is not built")
class TheCommand(unittest.TestCase):
    """On a copy of the colliding drops, shortened."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="undertow-test-"))
        self.addCleanup(shutil.rmtree, self.folder)
        shutil.copytree(TOP / "cases" / "verify_sph" / "colliding_drops", self.folder / "drops")

    def run_with(self, *changes):
        case = self.folder / "drops" / "case.toml"
        text = case.read_text()
        for old, new in changes:
            self.assertIn(old, text)
            text = text.replace(old, new)
        case.write_text(text)
        told = io.StringIO()
        with contextlib.redirect_stdout(told), contextlib.redirect_stderr(told):
            code = main(["verify", str(self.folder / "drops"), "--level", "coarse", "--quick", "--out", str(self.folder / "out")])
        return code, told.getvalue()

    def test_a_kept_gate_ends_well_and_leaves_figures(self):
        code, told = self.run_with()
        self.assertEqual(code, 0, told)
        figures = json.loads((self.folder / "out" / "drops.json").read_text())
        self.assertTrue(figures["ok"])
        self.assertGreater(figures["rungs"][0]["figures"]["cpu_s"], 0)

    def test_a_missed_gate_fails(self):
        code, told = self.run_with(('"linear momentum over sum m |v|" = 1e-07', '"linear momentum over sum m |v|" = 1e-15'))
        self.assertEqual(code, 1, told)
        self.assertIn("FAILS", told)

    def test_a_run_that_ends_early_fails_with_its_last_words(self):
        code, told = self.run_with(("[time]\n", "[time]\nmin_step = 1e-3\n"))   # twice the stable step
        self.assertEqual(code, 1, told)
        self.assertIn("sph_solver failed with exit code", told)

    def test_an_unknown_name_lists_the_known_ones(self):
        told = io.StringIO()
        with contextlib.redirect_stderr(told):
            self.assertEqual(main(["verify", "standing_wav"]), 2)
        self.assertIn("standing_wave", told.getvalue())


if __name__ == "__main__":
    unittest.main()
