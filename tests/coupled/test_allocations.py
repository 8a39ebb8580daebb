"""A step of a real trio allocates nothing in the coupler, the SPH or the FEM program: counted at malloc
(count_allocations.c) between two steps of the run. What is not of each step may allocate: searches for
contact and rebuilds of lists (some per hundred steps), field output, and the status once a second."""
import pathlib
import struct
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "faults"))
from harness import BIN, Scene  # noqa: E402

WARM, STEPS = 2000, 6000
NAMES = {"coupler": "coupler", "sph": "sph_solver", "fem": "fem_solver"}
QUIET = ("--set", "output.fields_every=100")
LIBRARY = BIN.parent / "lib" / "libcount_allocations.so"


class Allocations(unittest.TestCase):
    def per_step(self, *options):
        """Allocations of each program, per step."""
        with Scene() as scene:
            folder = scene.path / "counts"
            folder.mkdir()
            counting = {"LD_PRELOAD": str(LIBRARY), "UNDERTOW_ALLOCATIONS": str(folder)}
            scene.start_trio(*QUIET, "--set", "coupling.join_timeout=60", "--set",
                             "coupling.deadline=60", *options, environment=counting)

            def counts(step):
                scene.wait_for_step(step, 200)
                at = scene.status()["step"]
                return at, {name: struct.unpack("<Q", (folder / file).read_bytes())[0]
                            for name, file in NAMES.items()}
            first, before = counts(WARM)
            last, after = counts(first + STEPS)
        figures = {name: (after[name] - before[name]) / (last - first) for name in NAMES}
        print(f"allocations per step over {last - first} steps:",
              ", ".join(f"{name} {figure:.3f}" for name, figure in figures.items()),
              file=sys.stderr)
        return figures

    def judge(self, *options):
        figures = self.per_step(*options)
        self.assertLess(figures["coupler"], 0.3)
        self.assertLess(figures["fem"], 0.02)
        # 3 rebuilds of the lists per 100 steps here, each with some 12 allocations
        self.assertLess(figures["sph"], 0.8)

    def test_steps(self):
        self.judge("--set", "output.history_every=100")

    def test_steps_that_each_write_a_row(self):
        self.judge("--set", "output.history_every=1e-6")


if __name__ == "__main__":
    unittest.main()
