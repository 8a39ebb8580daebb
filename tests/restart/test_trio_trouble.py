"""The three programs on a disk that is slow, full, or gone with the program in the middle of a
checkpoint: what they say, and that the set before goes on, byte for byte."""
import re
import signal
import unittest

from scenes import TOP, poor_disk
from trios import Trios

EVERY = ("--set", "checkpoint.every=0.02", "--set", "checkpoint.keep=100")


# The wall on a spring as one that does not say it can write checkpoints.
WALL_WITHOUT = f"""import sys
sys.path.insert(0, {str(TOP / "scripts" / "backends")!r})
import backend, spring_wall
joined = backend.Participant
backend.Participant = lambda *words, **named: joined(*words, **{{**named, "capabilities": []}})
sys.exit(backend.main("spring_wall", "spring_wall 0.1.0", "without checkpoints", spring_wall.SpringWall))
"""


class TrioTrouble(Trios):
    @classmethod
    def setUpClass(cls):
        """The whole run, and the names of its sets."""
        super().setUpClass()
        scene = cls("not_yet")
        cls.whole = scene.trio(*EVERY)
        cls.first, cls.second = [folder.name for folder in cls.whole.sets()][:2]
        cls.addClassCleanup(scene.doCleanups)

    def begin(self, environment, *options):
        run = self.not_yet(*EVERY, *options)
        return run, self.start(run, environment=environment)

    def goes_on_from_the_first(self, run):
        self.assertEqual([folder.name for folder in run.sets()], [self.first])
        run.go_on()
        self.whole.must_equal(run)
        self.assertEqual([folder.name for folder in run.sets()],
                         [folder.name for folder in self.whole.sets()])
        self.assertEqual(list(run.out.glob("checkpoints/*/*.tmp")), [])

    def test_a_slow_disk_is_no_hang(self):
        run, tool = self.begin(poor_disk(self.first, slow=0.025), "--set", "coupling.deadline=2")
        self.wait(lambda: self.status(run).get("doing") == f"writing {self.first}", "the status")
        said = tool.communicate()[0]
        self.assertEqual(tool.returncode, 0, said)
        for log in ("sph_solver.log", "fem_solver.log", "coupler.log"):
            took = float(re.search(rf"checkpoint {self.first} at .* in (\S+) s",
                                   (run.out / log).read_text())[1])
            self.assertGreater(took, 2.4, f"{log}: the disk was not slow")
        self.whole.must_equal(run)
        self.assertIn("last checkpoint at t = 0.06 s", self.status_line(run))

    def test_a_full_disk_leaves_the_set_before(self):
        for who in ("sph", "fem", "coupler"):
            with self.subTest(who):
                run, tool = self.begin(poor_disk(f"{self.second}/{who}.h5", room=20000))
                said = tool.communicate()[0]
                self.assertEqual(tool.returncode, 2, said)
                self.assertIn(f"{who}.h5 could not be written: No space left on device; the sets "
                              "before it are whole.", said)
                for log in ("sph_solver.log", "fem_solver.log", "coupler.log"):
                    self.assertIn(f"{self.second}/{who}.h5", (run.out / log).read_text())
                self.goes_on_from_the_first(run)

    def test_a_backend_that_cannot_is_refused_by_name(self):
        run = self.not_yet()
        program = run.out.parent / "wall.py"
        program.write_text(WALL_WITHOUT)
        backend = ("--backend", program, "--with", "spring")
        said = self.tool("run", run.case, "--out", run.out, *backend, *EVERY, code=2)
        self.assertIn("trio.toml: [checkpoint]: fem (spring_wall 0.1.0) cannot write checkpoints; "
                      "leave the table out.", said)
        for log in ("sph_solver.log", "fem_solver.log", "coupler.log"):
            self.assertIn("cannot write checkpoints", (run.out / log).read_text())
        self.assertEqual(list(run.out.glob("checkpoints/*")), [])
        # without the table it runs, and says why there is nothing to go on from
        kept, run = run, self.not_yet()     # whose folder holds the program
        self.tool("run", run.case, "--out", run.out, *backend)
        self.assertIn("holds no checkpoint", self.tool("resume", run.out, code=2))

    def test_killed_in_the_middle_of_a_checkpoint(self):
        for who in ("sph", "fem", "coupler"):
            with self.subTest(who):
                run, tool = self.begin(poor_disk(self.second, slow=0.01))
                part = run.out / "checkpoints" / self.second / f"{who}.h5.tmp"
                self.wait(part.exists, part.name)
                self.signal(tool, who, signal.SIGKILL)
                said = tool.communicate()[0]
                self.assertEqual(tool.returncode, 3, said)
                self.assertIn("was ended by signal 9", said)
                self.goes_on_from_the_first(run)


if __name__ == "__main__":
    unittest.main()
