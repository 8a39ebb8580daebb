"""fem_solver alone, cut and resumed: every class with a memory of its own, byte for byte."""
import json
import unittest

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
