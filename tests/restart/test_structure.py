"""fem_solver alone, cut and resumed: every class with a memory of its own, byte for byte."""
import json
import unittest

import h5py

from scenes import Restart


class Structure(Restart):
    program = "fem_solver"

    def assert_flows(self, run):
        self.assertGreater(run.column("energy.fem.csv", "plastic")[-1], 0)

    def test_one_point_hexahedra_that_yield_and_are_told_to_move(self):
        self.assert_flows(self.check("structure.toml", every=5.3e-4))

    def test_b_bar_hexahedra(self):
        self.assert_flows(self.check("structure.toml", "--with", "b_bar", every=5.3e-4))

    def test_tetrahedra(self):
        self.assert_flows(self.check("structure.toml", "--with", "tetrahedra", every=5.3e-4))

    def test_shells_that_yield_in_layers(self):
        self.assert_flows(self.check("structure.toml", "--with", "shells", every=5.3e-4))

    def test_implicit_parts(self):
        whole = self.check("structure.toml", "--with", "implicit", every=2.7e-3)
        figures = json.loads((whole.out / "summary.fem.json").read_text())["implicit"]
        self.assertGreater(figures["assemblies"], 2)

    def test_stiffness_damping(self):
        whole = self.check("structure.toml", "--with", "damped", every=5.3e-4)
        self.assertGreater(whole.column("energy.fem.csv", "damping")[-1],
                           1.1 * self.new("structure.toml").go().column("energy.fem.csv", "damping")[-1])

    def test_tetrahedra_that_dilate_from_a_stress_at_rest(self):
        self.assert_flows(self.check("structure.toml", "--with", "sand", every=5.3e-4))

    def test_rigid_shells_on_clay_whose_strength_grows_with_depth(self):
        for options in ((), ("--with", "b_bar")):
            whole = self.check("plate.toml", *options, every=3.1e-3)
            self.assert_flows(whole)
            self.assertGreater(whole.column("fem.history.sole.csv", "slipping")[-1], 0)
            with h5py.File(whole.out / "fem.vtkhdf") as fields:
                found = []
                fields.visit(lambda name: found.append(name) if name.endswith("strength") else None)
                self.assertTrue(found)

    def test_thrown_with_a_spin(self):
        whole = self.check("structure.toml", "--with", "thrown", every=5.3e-4)
        energy = whole.column("energy.fem.csv", "given at the start")
        self.assertGreater(energy[0], 0)
        self.assertEqual(energy[0], energy[-1])

    def test_two_threads(self):
        self.check("structure.toml", "--with", "many", every=7.7e-5)

    def test_foundation_that_settles_slips_and_yields(self):
        whole = self.check("foundation.toml", every=3.1e-3)
        self.assert_flows(whole)
        self.assertGreater(whole.column("fem.history.skirt.csv", "slipping")[-1], 0)

    def test_foundation_that_is_told_to_move(self):
        self.check("foundation.toml", "--with", "driven", every=3.1e-3)


if __name__ == "__main__":
    unittest.main()
