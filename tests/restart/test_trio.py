"""The three programs, cut and resumed: fields, forces, histories and summaries, byte for byte."""
import json
import shutil
import signal
import subprocess
import time
import unittest

from scenes import ENVIRONMENT, Restart


class Trio(Restart):
    program = "coupler"

    def trio(self, *options, case="trio.toml"):
        """A run of scripts/undertow with these options."""
        run = self.new(case, *options)
        run.go_on = lambda *more, code=0: self.tool("resume", run.out, *more, code=code)
        self.tool("run", run.case, "--out", run.out, "--threads", 1, *options)
        return run

    def check_trio(self, *options):
        whole = self.trio(*options)
        cut = self.trio(*options, "--set", "checkpoint.every=0.0073", "--set", "checkpoint.keep=100")
        with self.subTest("checkpoints change nothing"):
            whole.must_equal(cut)
        sets = cut.sets()
        self.assertGreater(len(sets), 5)
        for k, threads in ((0, 1), (len(sets) // 2, 2), (len(sets) - 1, 1)):
            cut.go_on("--from", sets[k].name, "--threads", threads)
            with self.subTest(resumed=sets[k].name, threads=threads):
                whole.must_equal(cut)
        return whole, cut

    def test_mud_and_water_on_a_plate(self):
        whole, cut = self.check_trio()
        self.assertGreater(whole.column("energy.interface.csv", "contacts")[-1], 0)
        self.assertGreater(whole.column("energy.interface.csv", "friction")[-1], 0)
        # some checkpoints fell on a step with a search, some between two
        searched = json.loads((whole.out / "summary.coupler.json").read_text())["searches"]
        self.assertGreater(searched, 3)

    def test_mud_and_water_on_shells(self):
        self.check_trio("--with", "shells")

    def test_sigterm_then_resume(self):
        whole = self.trio()
        run = self.new("trio.toml")
        tool = subprocess.Popen(
            self.tool_command("run", run.case, "--out", run.out, "--threads", 1, "--set",
                              "checkpoint.every=10"), env=ENVIRONMENT, stdout=subprocess.DEVNULL)
        fields = run.out / "sph.xdmf"
        end = time.monotonic() + 60
        while not fields.exists() or fields.read_text().count("<Time") < 3:
            self.assertLess(time.monotonic(), end)
            time.sleep(0.005)
        tool.send_signal(signal.SIGTERM)
        self.assertEqual(tool.wait(60), 130)
        (folder,) = run.sets()
        manifest = json.loads((folder / "manifest.json").read_text())
        self.assertEqual([file["who"] for file in manifest["files"]], ["sph", "fem", "coupler"])
        self.tool("resume", run.out)
        whole.must_equal(run)

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
