"""Joining of summaries, histories, and the dam-break report on made-up data."""
import copy
import json
import pathlib
import sys
import tempfile
import unittest

import numpy as np

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "scripts"))

from undertow_tool import report as reports  # noqa: E402
from undertow_tool.checks import all_ok, check, in_band, relative  # noqa: E402
from undertow_tool.estimate import estimate, wave_speed  # noqa: E402
from undertow_tool.history import read_history  # noqa: E402
from undertow_tool.join import join_energy, join_summaries  # noqa: E402
from undertow_tool.table import check_table, comparison_table, console, figures, shares  # noqa: E402

DEPTH, GATE, WALL, G, RHO = 0.3, 0.6, 1.61, 9.81, 997.0
STAR = np.sqrt(G / DEPTH)
BOX = {"min": [0, 0, 0], "max": [0.6, 0.15, 0.3]}
CASE = {
    "file": "case.toml", "folder": str(TOP / "cases" / "dam_break"), "coupled": True,
    "known_levels": [], "known_variants": [],
    "case": {"name": "dam_break", "title": "Dam break", "dimension": 3, "thickness": 1, "gravity": [0, 0, -G]},
    "time": {"end": 0.9, "max_step": None}, "output": {"fields_every": 0.01},
    "sph": {"spacing": 0.01, "smoothing_ratio": 1.2, "cfl": 0, "integrator": "auto", "max_speed": 0,
            "fluid": [{"name": "water", "density": RHO, "sound_speed": "auto"}],
            "fill": [{"box": BOX, "velocity": [0, 0, 0]}]},
    "fem": {"mesh": "", "cfl": 0.9, "surface": [{"name": "wall", "set": "xmin"}],
            "block": {"box": {"min": [1.61, 0, 0], "max": [1.63, 0.15, 0.6]}, "divisions": [1, 8, 30]},
            "material": [{"name": "pmma", "density": 1190, "young_modulus": 3.2e9, "poisson_ratio": 0.32}],
            "part": [{"set": "block", "material": "pmma", "implicit": False}], "rigid": []},
    "coupling": {"law": "fluid", "skin": 0.3, "beta": 0.25, "damping": 0.1, "patch": []},
    "report": {"depth": DEPTH, "gate": GATE, "wall": WALL, "snapshots": [1.0, 2.0],
               "sensors": {"P1": 0.003, "P2": 0.015, "P3": 0.030, "P4": 0.080}},
}


def write_csv(path, **columns):
    names = list(columns)
    rows = np.column_stack([columns[name] for name in names])
    header = ",".join(name.replace("__", ".") + (" [s]" if name == "t" else " [m]") for name in names)
    path.write_text("# made up\n" + header + "\n" + "".join(",".join(f"{v:.9g}" for v in row) + "\n" for row in rows))


class Folder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.out = pathlib.Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()


class JoinTest(Folder):
    def test_flat_and_nested_parts_join(self):
        (self.out / "summary.sph.json").write_text(json.dumps({"steps": 10, "sph": {"particles": 27000}, "wait_s": 1}))
        (self.out / "summary.fem.json").write_text(json.dumps({"steps": 10, "elements": 240, "dt_min": 2e-6}))
        (self.out / "summary.coupler.json").write_text(json.dumps(
            {"steps": 11, "dt_mean": 1e-5, "coupling": {"momentum_residual": 1e-15}}))
        joined = join_summaries(self.out)
        self.assertEqual(joined["steps"], 11)                 # the coupler's count goes before the solvers'
        self.assertEqual(joined["dt_min"], 2e-6)              # what only one of them knows
        self.assertEqual(joined["sph"]["particles"], 27000)
        self.assertEqual(joined["sph"]["wait_s"], 1)
        self.assertEqual(joined["fem"]["elements"], 240)
        self.assertEqual(joined["coupling"]["momentum_residual"], 1e-15)

    def test_the_overhead_is_what_the_slower_solver_waits(self):
        (self.out / "summary.sph.json").write_text(json.dumps({"sph": {"particles": 1}, "wait_s": 6.0}))
        (self.out / "summary.fem.json").write_text(json.dumps({"elements": 1, "wait_s": 90.0}))
        (self.out / "summary.coupler.json").write_text(json.dumps({"wall_s": 100.0}))
        coupling = join_summaries(self.out)["coupling"]
        self.assertAlmostEqual(coupling["overhead_fraction"], 0.06)
        self.assertAlmostEqual(coupling["fem_wait_fraction"], 0.90)

    def test_a_solver_that_ran_alone_speaks_for_the_run(self):
        (self.out / "summary.sph.json").write_text(json.dumps({"steps": 5, "sph": {"particles": 8}}))
        joined = join_summaries(self.out)
        self.assertEqual(joined["steps"], 5)
        self.assertNotIn("fem", joined)

    def test_a_half_written_part_is_no_part(self):
        (self.out / "summary.sph.json").write_text('{"steps": 5, "sph"')
        self.assertEqual(join_summaries(self.out), {})

    def test_energies_join_on_the_times_of_the_fluid(self):
        t = np.linspace(0, 1, 11)
        (self.out / "energy.sph.csv").write_text("t [s],kinetic [J]\n" + "".join(f"{a},{2 * a}\n" for a in t))
        (self.out / "energy.fem.csv").write_text("t [s],kinetic [J]\n0,0\n0.5,1\n1,2\n")
        joined = read_history(join_energy(self.out))
        np.testing.assert_allclose(joined["sph.kinetic"], 2 * t)
        np.testing.assert_allclose(joined["fem.kinetic"], 2 * t)
        self.assertEqual(joined.units["fem.kinetic"], "J")

    def test_a_history_cut_in_the_middle_of_a_row_keeps_its_whole_rows(self):
        (self.out / "a.csv").write_text("# note\nt [s],p [Pa]\n0,1\n1,2\n2")
        history = read_history(self.out / "a.csv")
        np.testing.assert_allclose(history["p"], [1, 2])
        self.assertEqual(history.notes, ["note"])


class CheckTest(unittest.TestCase):
    def test_verdicts(self):
        self.assertTrue(relative("a", 1.04, 1.0, 0.05)["ok"])
        self.assertFalse(relative("a", 1.06, 1.0, 0.05)["ok"])
        self.assertIsNone(relative("a", 9.0, 1.0)["ok"])
        self.assertFalse(check("a", float("nan"), 0.0, float("nan"), 1.0)["ok"])
        self.assertTrue(in_band("a", 2.0, 3.0, 1.5, 4.0)["ok"])
        self.assertFalse(in_band("a", 1.4, 3.0, 1.5, 4.0)["ok"])
        self.assertFalse(all_ok([relative("a", 1.0, 1.0, 0.1), relative("b", 2.0, 1.0, 0.1)]))

    def test_tables_print_missing_values(self):
        rows = [relative("speed", None, 1.0, 0.05), in_band("peak", 2.0, 3.0, 1.5, 4.0)]
        screen = console()
        with screen.capture() as captured:
            screen.print(check_table("title", rows))
            screen.print(comparison_table([("a", {"checks": rows}), ("b", {"wall_s": 1.0})]))
        self.assertIn("-33.3 %", captured.get())
        self.assertEqual(figures({"wall_s": 2.0})[0], "wall time 2 s")
        self.assertEqual(figures({"wall_s": 2.0, "sph": {"max_speed": 2.0927, "max_density_deviation": 0.0076, "removed": 0,
                                                         "put_back_behind_walls": 1303}, "fem": {"max_displacement": 0.042048}})[1:],
                         ["fluid: fastest 2.09 m/s, density within 0.76 %, 1,303 put back behind walls",
                          "structure: largest displacement 0.04205 m"])
        self.assertEqual(shares({"sph: sound": 3, "output": 1}), "sph: sound 75 %, output 25 %")


class EstimateTest(unittest.TestCase):
    def test_the_wave_speed_of_the_element_has_one_minus_two_nu(self):
        # steel: tables give 5.9 to 6.0 km/s for the longitudinal wave
        self.assertAlmostEqual(wave_speed({"young_modulus": 210e9, "poisson_ratio": 0.3, "density": 7850}), 6001, delta=1)

    def test_counts_and_limits_of_the_dam_break(self):
        figures_ = estimate(CASE, 2)
        self.assertEqual(figures_["particles"], 27000)
        self.assertEqual(figures_["elements"], 240)
        self.assertIn("fem", figures_["limiter"])
        # 18.75 mm at 1962 m/s with 0.9
        self.assertAlmostEqual(figures_["dt"], 0.9 * 0.01875 / 1962, delta=1e-8)

    def test_an_implicit_part_limits_no_step(self):
        case = copy.deepcopy(CASE)
        case["fem"]["part"][0]["implicit"] = True
        self.assertIn("sph", estimate(case, 2)["limiter"])

    def test_steps_of_the_fluid_itself_take_two_passes_and_longer(self):
        from undertow_tool.estimate import PARTICLE_STEPS_PER_S, TWO_PASS_STEPS_PER_S, particle_rate
        # c0 + v = 37.7 m/s: one pass bears 6.6e-5 s, and is taken up to half of that
        self.assertEqual(particle_rate(CASE, 3e-5), PARTICLE_STEPS_PER_S)
        self.assertEqual(particle_rate(CASE, 4e-5), TWO_PASS_STEPS_PER_S)
        forced = copy.deepcopy(CASE)
        forced["sph"]["integrator"] = "one_pass"
        self.assertEqual(particle_rate(forced, 4e-5), PARTICLE_STEPS_PER_S)
        forced["sph"]["smoothing_ratio"] = 1.5
        self.assertLess(particle_rate(forced, 4e-5), 0.8 * PARTICLE_STEPS_PER_S)


class DamBreakReportTest(Folder):
    """The report on the experiment's own curves must find no error, and on others it must."""

    def setUp(self):
        super().setUp()
        self.front = read_history(TOP / "cases/dam_break/reference/lobovsky2014_front_H300.csv")
        self.pressure = read_history(TOP / "cases/dam_break/reference/lobovsky2014_pressure_percentiles_H300.csv")
        self.t = np.arange(0, 0.9, 4.5e-4)

    def write(self, front_factor=1.0, pressure_delay=0.0, pressure_factor=1.0):
        """Histories after the experiment: front position times a factor, pressures later and larger."""
        curve_t = np.append(self.front["tstar"], 2.573)
        curve_x = np.append(self.front["x_over_H"], (WALL - GATE) / DEPTH)
        x = np.minimum(front_factor * np.interp(self.t * STAR, curve_t, curve_x), (WALL - GATE) / DEPTH)
        write_csv(self.out / "gauges.csv", t=self.t, front=GATE + DEPTH * x)
        columns = {s: pressure_factor * RHO * G * DEPTH
                   * np.interp(self.t * STAR - pressure_delay, self.pressure["tstar"], self.pressure[f"{s}_med"])
                   for s in ("P1", "P2", "P3", "P4")}
        write_csv(self.out / "patches.csv", t=self.t, **columns)
        write_csv(self.out / "forces.csv", t=self.t, wall__water__fx=columns["P1"] * 0.01)
        summary = {"coupling": {"momentum_residual": 1e-15}}
        return {row["name"]: row for row in reports.run_report(self.out, CASE, summary)}

    def test_the_experiment_agrees_with_itself(self):
        rows = self.write()
        self.assertEqual(len(rows), 11)
        self.assertLess(rows["front X = x/H, RMS over t* = 0.5, 1, 1.5, 2, 2.4"]["value"], 1e-3)
        # a least-squares line through the paper's own curve: the known refit
        self.assertAlmostEqual(rows["front speed dX/dt*, 1 < t* < 2.4"]["value"], 1.53, delta=0.01)
        self.assertTrue(all_ok(rows.values()), [r["name"] for r in rows.values() if r["ok"] is False])
        self.assertGreater((self.out / "report.png").stat().st_size, 20000)

    def test_pressures_are_compared_from_arrival_on_and_the_front_is_not_shifted(self):
        rows = self.write(pressure_delay=0.5)
        self.assertTrue(all_ok(rows.values()), [r["name"] for r in rows.values() if r["ok"] is False])

    def test_errors_are_found(self):
        rows = self.write(front_factor=1.1, pressure_factor=1.6)
        self.assertFalse(rows["front X = x/H, RMS over t* = 0.5, 1, 1.5, 2, 2.4"]["ok"])
        self.assertFalse(rows["front speed dX/dt*, 1 < t* < 2.4"]["ok"])
        self.assertFalse(rows["P2 first peak, p/(rho g H)"]["ok"])
        self.assertFalse(rows["P1 mean after impact, p/(rho g H)"]["ok"])

    def test_a_short_run_has_only_the_checks_it_reached(self):
        self.t = np.arange(0, 0.2, 4.5e-4)
        self.assertEqual(set(self.write()), {"momentum given by the water less received by the wall"})


class NarrowTerminal(unittest.TestCase):
    def test_eighty_columns_have_the_notes_below_and_whole_names_in_the_table(self):
        from rich.console import Console
        from undertow_tool.table import print_report
        rows = [relative(f"P{k} mean after impact, p/(rho g H)", 0.9, 0.7, 0.1, note="1.2 to 2.4 t* after arrival") for k in (1, 2)]
        told = {}
        for width in (80, 120):
            screen = Console(width=width, highlight=False)
            with screen.capture() as capture:
                print_report(pathlib.Path("/nowhere"), {"checks": rows, "title": "t"}, screen)
            told[width] = capture.get()
        self.assertIn("P1 mean after impact", told[80])
        self.assertIn("P1 mean after impact, p/(rho g H); P2 mean", told[80])
        self.assertEqual(told[80].count("after arrival"), 1)
        self.assertEqual(told[120].count("after arrival"), 2)


class WarningsAtTheEnd(Folder):
    def told(self, summary):
        import contextlib
        import io
        from undertow_tool.commands import say_warnings
        with contextlib.redirect_stdout(io.StringIO()) as said:
            say_warnings([], self.out, summary)
        return said.getvalue()

    def test_a_surface_that_nothing_touched_is_told(self):
        self.assertIn("no particle ever touched the coupled surface", self.told({"coupling": {"contacts_max": 0}}))
        self.assertEqual(self.told({"coupling": {"contacts_max": 1}}), "")
        self.assertEqual(self.told({"sph": {}}), "")        # no coupler, no surface


class DefaultReport(Folder):
    """The picture of a case that has no report.py."""

    HEXAHEDRA = np.array([[0, 1, 2, 3, 4, 5, 6, 7], [4, 5, 6, 7, 8, 9, 10, 11]])

    def mesh(self, **views):
        import h5py
        with h5py.File(self.out / "fem.vtkhdf", "w") as file:
            file["VTKHDF/Steps/Values"] = np.array([0.0, 1.0])
            for name, value in views.items():
                file[f"Views/{name}"] = value
            x = np.array([(i, j, k) for k in range(3) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))], dtype=float)
            for step in ("00000", "00001"):
                file[f"Views/{step}/Points"] = x
                file[f"Views/{step}/CellData/von_mises"] = np.array([1e6, 2e6])

    def case(self, **changes):
        case = copy.deepcopy(CASE)
        case["folder"] = str(self.out)
        case.update(changes)
        return case

    def test_outer_faces_are_those_of_one_solid_alone_and_all_shells(self):
        from undertow_tool.fields import split_cells
        from undertow_tool.scene import outer_faces
        faces, owners = outer_faces({9: (np.arange(2), self.HEXAHEDRA)})
        self.assertEqual(len(faces), 10)                    # two cubes, less the two sides that meet
        self.assertEqual(sorted(np.bincount(owners)), [5, 5])
        cells = split_cells(np.array([6, 0, 1, 2, 4, 6, 1, 2, 3, 4, 5, 5, 6, 7, 8, 4, 8, 9, 10]))
        faces, owners = outer_faces(cells)                  # two tetrahedra on a common side, a quad, a triangle
        self.assertEqual(sorted(np.bincount(owners)), [1, 1, 3, 3])
        self.assertNotIn([1, 2, 4, 4], [sorted(face.tolist()) for face in faces])

    def test_bodies_are_where_their_law_puts_them_and_unknown_places_are_not_guessed(self):
        from undertow_tool.scene import outline, place_of
        body = {"box": {"min": [0, 0, 1], "max": [2, 1, 3]}, "velocity": [1.0, 0, 2.0], "start": 0.5, "stop": 1.5}
        self.assertEqual(outline(body).tolist(), [[0, 1], [2, 1], [2, 3], [0, 3]])
        self.assertEqual(place_of(body, 0.2).tolist(), [0, 0])
        self.assertEqual(place_of(body, 9).tolist(), [1, 2])
        self.assertIsNone(place_of({**body, "displacement": ["t", "0", "0"]}, 1))
        pipe = outline({"from": [1, 0, 2], "to": [1, 5, 2], "radius": 0.5})
        self.assertTrue(np.allclose(np.hypot(pipe[:, 0] - 1, pipe[:, 1] - 2), 0.5))

    def test_panels_show_what_changes_in_units_near_one(self):
        from undertow_tool.default_report import panels_of, prefixed
        t = np.linspace(0, 1, 50)
        (self.out / "fem.history.csv").write_text("t [s],tip.ux [m],tip.uy [m],tip.vx [m/s]\n" + "".join(
            f"{a},{1e-3 * a},0,{a}\n" for a in t))
        (title, unit, lines), = panels_of(self.out, self.case())
        self.assertEqual((title, unit, [label for label, _, _ in lines]), ("Displacements", "m", ["tip.ux"]))
        self.assertEqual(prefixed(1e-3, "m"), (1e3, "mm"))
        self.assertEqual(prefixed(2.5e6, "Pa"), (1e-6, "MPa"))
        self.assertEqual(prefixed(0.3, "m3/s"), (1, "m3/s"))
        self.assertEqual(prefixed(5000.0, "m"), (1, "m"))

    def test_noise_is_told_from_a_motion_of_twenty_rows(self):
        from undertow_tool.default_report import is_rough
        row = np.arange(1000)
        self.assertFalse(is_rough(np.sin(2 * np.pi * row / 20) + row / 200))
        self.assertTrue(is_rough(np.sin(2 * np.pi * row / 20) * (-1) ** row))
        self.assertTrue(is_rough(row / 1000 + 0.1 * np.random.default_rng(1).standard_normal(1000)))

    def test_a_mean_keeps_straight_lines_and_the_ends(self):
        from undertow_tool.default_report import moving_mean
        line = np.linspace(-1, 3, 200)
        self.assertTrue(np.allclose(moving_mean(line), line))

    def test_it_is_drawn_with_and_without_fields_and_a_report_of_the_case_comes_first(self):
        case = self.case(sph=None, coupled=False)
        reports.run_report(self.out, case, {})
        self.assertFalse((self.out / "report.png").exists())        # nothing to draw is no failure
        self.mesh(Hexahedra=self.HEXAHEDRA)
        summary = {}
        reports.run_report(self.out, case, summary)
        self.assertEqual(summary["checks"], [])
        self.assertEqual((self.out / "report.png").read_bytes()[:4], b"\x89PNG")
        (self.out / "report.png").unlink()
        (self.out / "report.py").write_text("def report(out, case, summary):\n    return [{'ok': True}]\n")
        reports.run_report(self.out, case, summary)
        self.assertEqual(summary["checks"], [{"ok": True}])
        self.assertFalse((self.out / "report.png").exists())


if __name__ == "__main__":
    unittest.main()
