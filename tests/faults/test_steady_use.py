"""Row 23 of docs/fault_matrix.md: memory and open files stay what they are. Some 10,000 steps, or
UNDERTOW_STEPS of them."""
import os
import unittest

from harness import Case, Scene, record

STEPS = int(os.environ.get("UNDERTOW_STEPS", 12000))
WARM = 3000         # steps until everything has been allocated once


class SteadyUse(Case):
    def watch(self, scene, patience, limit):
        scene.wait_for_step(WARM, patience)
        names = ("coupler", "sph", "fem")
        first_step = scene.status()["step"]
        memory = {name: scene[name].memory() for name in names}
        files = {name: scene[name].descriptors() for name in names}
        scene.wait_for_step(first_step + STEPS, patience + STEPS // 100)
        grown = {name: scene[name].memory() - memory[name] for name in names}
        steps = scene.status()["step"] - first_step
        for name in names:
            self.assertLess(grown[name], limit, f"{name} grew by {grown} kB in {steps} steps")
            self.assertEqual(scene[name].descriptors(), files[name], f"open files of {name}")
        record(23, f"{steps} steps: " + ", ".join(f"{name} {grown[name]:+d} kB"
                                                   for name in names) + "; open files unchanged")

    def test_the_coupler_between_dummies(self):
        with Scene("dummies") as scene:
            scene.start_coupler("--set", "output.history_every=1")
            scene.start_dummy("particles", "--height", "0.05", "--load", "-10")
            scene.start_dummy("surface", "--height", "0", "--spring", "1e4")
            self.watch(scene, 200, 1024)

    def test_the_three_programs(self):
        with Scene() as scene:
            scene.start_trio("--set", "output.fields_every=10", "--set", "output.history_every=0.1")
            self.watch(scene, 200, 1024)


if __name__ == "__main__":
    unittest.main()
