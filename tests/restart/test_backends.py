"""The Python backends in the place of fem_solver, cut and resumed: byte for byte against the whole run."""
import importlib.util
import shutil
import unittest

from scenes import TOP
from trios import Trios

TABLES = {
    "spring_wall": "{ origin = [-0.06, -0.02, 0], u = [0.24, 0, 0], v = [0, 0.12, 0], divisions = [6, 3], "
                   "mass = 0.5, stiffness = 2e3, damping_ratio = 0.05 }",
    "beam": "{ origin = [-0.06, -0.02, 0], span = [0.24, 0, 0], width = [0, 0.12, 0], divisions = [8, 3], "
            "ends = ['clamped', 'clamped'], across = 'loose', thickness = 0.01, density = 1500, young_modulus = 1e7, "
            "damping_ratio = 0.02 }",
    "rigid_body": "{ box = [-0.06, -0.02, -0.05, 0.18, 0.10, 0], divisions = [6, 3, 1], mass = 1.5, "
                  "stiffness = [2e3, 2e3, 4e3], rocking = [20, 20, 10], damping_ratio = 0.05 }",
    "getfem_wall": "{ box = [-0.06, -0.02, -0.02, 0.18, 0.10, 0], divisions = [6, 3, 1], wet = 'zmax', "
                   "held = ['xmin', 'xmax'], density = 1500, young_modulus = 1e6, poisson_ratio = 0.3 }"}


class Backends(Trios):
    def options(self, backend):
        return ("--backend", TOP / "scripts/backends" / f"{backend}.py", "--set", "time.end=0.05", "--set",
                f"backend.{backend}={TABLES[backend]}".replace("'", '"'))

    def check(self, backend, moved):
        whole, _ = self.check_trio(*self.options(backend), every=0.0077)
        self.assertGreater(max(map(abs, whole.column("fem.history.csv", moved))), 0)
        self.assertGreater(max(whole.column("energy.interface.csv", "contacts")), 0)

    def test_a_wall_on_a_spring(self):
        self.check("spring_wall", "displacement")

    def test_beams(self):
        self.check("beam", "largest displacement")

    def test_a_block_on_soil_springs(self):
        self.check("rigid_body", "theta y")

    @unittest.skipUnless(importlib.util.find_spec("getfem") and importlib.util.find_spec("scipy"),
                         "needs python3-getfem and python3-scipy")
    def test_a_block_by_getfem(self):
        self.check("getfem_wall", "probe displacement z")

    def test_what_does_not_fit_is_refused_by_name(self):
        run = self.trio(*self.options("spring_wall"), "--set", "checkpoint.every=0.01")
        folder = run.sets()[0]
        rows = (run.out / "fem.history.csv").read_text()

        def refused(*words):
            told = self.tool("resume", run.out, "--from", folder.name, code=2)
            for word in words:
                self.assertIn(word, told)
            self.assertEqual((run.out / "fem.history.csv").read_text(), rows, "nothing was cut")

        file, manifest = folder / "fem.npz", folder / "manifest.json"
        whole = file.read_bytes()
        file.write_bytes(whole[:-1] + bytes([whole[-1] ^ 1]))
        refused("fem.npz is not the file that the manifest names")
        file.write_bytes(whole)
        text = manifest.read_text()
        manifest.write_text(text.replace('"fem.npz"', '"fem.h5"'))
        refused("was written with another structure (its file is fem.h5")
        manifest.write_text(text)
        shutil.copy(run.sets()[1] / "fem.npz", file)
        refused("fem.npz is not the file that the manifest names")
        file.write_bytes(whole)
        self.tool("resume", run.out, "--from", folder.name)


if __name__ == "__main__":
    unittest.main()
