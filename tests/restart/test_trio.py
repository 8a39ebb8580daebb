"""The three programs, cut and resumed: fields, forces, histories and summaries, byte for byte."""
import json
import shutil
import signal
import subprocess
import time
import unittest

import h5py

from scenes import ENVIRONMENT, slow_fields
from trios import Trios


class Trio(Trios):
    def test_mud_and_water_on_a_plate(self):
        whole, cut = self.check_trio()
        self.assertGreater(whole.column("energy.interface.csv", "contacts")[-1], 0)
        self.assertGreater(whole.column("energy.interface.csv", "friction")[-1], 0)
        # some checkpoints fell on a step with a search, some between two
        searched = json.loads((whole.out / "summary.coupler.json").read_text())["searches"]
        self.assertGreater(searched, 3)

    def test_mud_and_water_on_shells(self):
        self.check_trio("--with", "shells")

    def test_mud_and_water_on_both_sides_of_a_thin_sheet(self):
        whole, cut = self.check_trio("--with", "both_sides")
        for run in whole, cut:  # the last one resumed
            plates = json.loads((run.out / "summary.sph.json").read_text())["sph"]["thin_plates"]
            self.assertEqual(plates["facets"], 36)
            self.assertGreater(plates["pairs_cut"], 500)
        self.assertIn("36 of 36 coupled facets", (whole.out / "sph_solver.log").read_text())

    def test_under_the_static_pressure_of_water(self):
        whole, _ = self.check_trio("--with", "under_water")
        without = self.trio()
        self.assertNotEqual(whole.column("fem.history.csv", "center"),
                            without.column("fem.history.csv", "center"))

    def test_a_fluid_that_comes_back_where_it_leaves(self):
        whole, _ = self.check_trio("--with", "periodic")
        self.assertGreater(whole.column("energy.interface.csv", "friction")[-1], 0)
        with h5py.File(whole.out / "sph.vtkhdf") as file:
            offset = file["VTKHDF/Steps/PointOffsets"][:]
            x, name = file["VTKHDF/Points"][:, 0], file["VTKHDF/PointData/id"][:]
        last = dict(zip(name[offset[-1]:], x[offset[-1]:]))
        passed = sum(last[k] < at for k, at in zip(name[:offset[1]], x[:offset[1]]))
        self.assertGreater(passed, 50, "who has passed the seam is behind where it began")

    def test_pressures_of_facets_at_an_interval_of_their_own(self):
        whole, _ = self.check_trio("--set", "output.contact_every=0.0041", "--set", "time.end=0.04", every=0.0057)
        with h5py.File(whole.out / "contact.vtkhdf") as file:
            t = file["VTKHDF/Steps/Values"][:]
        # 0, each multiple of 4.1 ms passed by a step at most, and the end
        self.assertEqual([int(v / 0.0041 * (1 + 1e-12)) for v in t], list(range(10)) + [9])
        none = self.trio("--set", "output.contact_fields=false", "--set", "time.end=0.04")
        self.assertFalse((none.out / "contact.vtkhdf").exists())
        with h5py.File(none.out / "sph.vtkhdf") as file, h5py.File(whole.out / "sph.vtkhdf") as other:
            self.assertTrue((file["VTKHDF/Points"][:] == other["VTKHDF/Points"][:]).all())

    def test_sigterm_then_resume(self):
        whole = self.trio()
        run = self.new("trio.toml")
        tool = subprocess.Popen(
            self.tool_command("run", run.case, "--out", run.out, "--threads", 1, "--set",
                              "checkpoint.every=10"), env={**ENVIRONMENT, **slow_fields("sph")},
            stdout=subprocess.DEVNULL)
        fields = run.out / "sph.xdmf"
        end = time.monotonic() + 120
        while not fields.exists() or fields.read_text().count("<Time") < 3:
            self.assertLess(time.monotonic(), end)
            time.sleep(0.005)
        tool.send_signal(signal.SIGTERM)
        self.assertEqual(tool.wait(), 130)
        (folder,) = run.sets()
        manifest = json.loads((folder / "manifest.json").read_text())
        self.assertEqual([file["who"] for file in manifest["files"]], ["sph", "fem", "coupler"])
        self.tool("resume", run.out)
        whole.must_equal(run)

    def test_a_recording_holds_the_checkpoints_and_is_not_touched_by_a_resume(self):
        run = self.trio("--record", "--set", "checkpoint.every=0.02", "--set", "checkpoint.keep=100")
        recordings = [run.out / f"recording.{who}.utow" for who in ("sph", "fem")]
        before = [path.read_bytes() for path in recordings]
        for resumed in (False, True):
            if resumed:
                run.go_on("--from", run.sets()[0].name)
            for who, path in zip(("sph", "fem"), recordings):
                with self.subTest(who, resumed=resumed):
                    self.assertIn(b"step_", path.read_bytes())
                    said = self.said_by("replay", run.out, who)
                    self.assertIn("every message is the recorded one, bit by bit", said)
                    self.assertFalse((run.out / f"replay.{who}" / "checkpoints").exists())
                    self.assertIn("checkpoint step_", (run.out / f"replay.{who}" / f"{who}_solver.log").read_text())
        self.assertEqual([path.read_bytes() for path in recordings], before)

    def test_files_of_two_sets_are_refused(self):
        run = self.trio("--set", "checkpoint.every=0.01", "--set", "time.end=0.025")
        old, new = run.sets()
        kept = (new / "sph.h5").read_bytes()
        shutil.copy(old / "sph.h5", new / "sph.h5")
        said = self.tool("resume", run.out, "--set", "time.end=0.03", code=2)
        self.assertIn("sph.h5 is not the file that the manifest", said)
        (new / "sph.h5").write_bytes(kept)
        said = self.tool("resume", run.out, "--set", "coupling.friction=0.3", code=2)
        self.assertIn("coupling.friction is 0.3, but", said)
        self.tool("resume", run.out, "--set", "time.end=0.03")


if __name__ == "__main__":
    unittest.main()
