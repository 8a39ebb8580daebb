"""The meshes that a case keeps are those that its recipe makes."""
import importlib.util
import math
import tempfile
import unittest
from pathlib import Path

CASES = Path(__file__).resolve().parents[2] / "cases"
BUCKET = CASES / "bucket"


def recipe(folder=BUCKET):
    spec = importlib.util.spec_from_file_location(f"{folder.name}_mesh", folder / "mesh.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class BucketMesh(unittest.TestCase):
    def made(self, width):
        module = recipe()
        mesh = module.build(20, 12, width)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "made.msh"
            module.write(mesh, path)
            return mesh, path.read_text()

    def test_kept_meshes_are_what_the_recipe_makes(self):
        for name, width in (("quick", 2.5), ("wide", 3.5)):
            self.assertEqual(self.made(width)[1], (BUCKET / "mesh" / f"{name}.msh").read_text(), name)

    def test_skirt_and_clay_stand_a_gap_apart_and_the_bed_shares_its_edge_with_the_clay(self):
        mesh, _ = self.made(2.5)
        clay = {n for facet in mesh.facets["clay_skirt"] for n in facet}
        radii = {round(math.hypot(*mesh.x[n][:2]), 4) for n in clay}
        self.assertEqual(radii, {0.975, 0.99, 1.005})       # inside, below the tip, outside
        shared = {n for f in mesh.facets["bed"] for n in f} & {n for f in mesh.facets["mud_line"] for n in f}
        self.assertTrue(all(abs(abs(mesh.x[n][0]) - 4) < 1e-9 for n in shared))
        self.assertGreaterEqual(len(shared), 2 * 8)
        self.assertFalse(clay & {n for f in mesh.facets["bucket_skirt"] for n in f})


class VerifiedMeshes(unittest.TestCase):
    def test_kept_meshes_are_what_the_recipes_make(self):
        for case, mesh, sizes in (("scordelis_lo", "roof", (8, 16, 32)), ("i_beam", "i_beam", (20, 40, 80)),
                                  ("pinched_cylinder", "cylinder", (8, 16, 32)), ("twisted_beam", "beams", (12, 24, 48)),
                                  ("bar_impact", "bars", (50, 100, 200)),
                                  ("hertz_cylinder", "hertz", (4, 8, 16)),
                                  ("sliding_block", "blocks", (2, 4, 8)), ("skirt_pull_out", "skirts", (4, 8, 16)),
                                  ("circular_footing", "clay", (4, 8, 12)),
                                  ("strip_footing", "clay", (4, 8, 16)),
                                  ("taylor_bar", "bar", (4, 6, 8))):
            folder = CASES / "verify_fem" / case
            for n in sizes:
                with tempfile.TemporaryDirectory() as made:
                    path = Path(made) / "made.msh"
                    recipe(folder).build(n).write(path)
                    self.assertEqual(path.read_text(), (folder / "mesh" / f"{mesh}_{n}.msh").read_text(), f"{mesh}_{n}")


if __name__ == "__main__":
    unittest.main()
