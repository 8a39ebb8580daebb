"""sph_solver alone, cut and resumed: every class with a memory of its own, byte for byte."""
import json
import unittest

from scenes import Restart


class Fluid(Restart):
    program = "sph_solver"

    def said_of(self, run):
        return (run.out / "sph_solver.log").read_text()

    def figures(self, run):
        return json.loads((run.out / "summary.sph.json").read_text())["sph"]

    def test_water_gate_and_a_stem_that_turns(self):
        whole = self.check("fluid.toml", every=0.037)
        self.assertGreater(self.figures(whole)["list_rebuilds"], 20)
        self.assertGreater(whole.column("gauges.csv", "through.total")[-1], 0)

    def test_sums_in_double_shifting_corrected_gradients_and_heat(self):
        self.check("fluid.toml", "--with", "exact", every=0.037)

    def test_one_pass(self):
        self.check("fluid.toml", "--with", "one_pass", every=0.037)

    def test_mud(self):
        self.check("fluid.toml", "--with", "mud", every=0.037)

    def test_two_sizes_that_follow_density(self):
        self.check("fluid.toml", "--with", "sizes", every=0.037)

    def test_a_slide_that_is_let_go(self):
        run = self.check("fluid.toml", "--with", "slide", every=0.037)
        self.assertEqual(self.said_of(run).count("relaxed start"), 1)
        cut = self.new("fluid.toml", "--with", "slide").go("--set", "checkpoint.every=0.2")
        cut.resume(cut.sets()[-1])
        self.assertEqual(self.said_of(cut).count("relaxed start"), 1, "relaxed again on resume")

    def test_a_stream_through_openings_and_a_beach(self):
        whole = self.check("fluid.toml", "--with", "stream", every=0.037)
        self.assertGreater(self.figures(whole)["particles"], 0)

    def test_a_periodic_channel_of_implicit_mud(self):
        self.check("fluid.toml", "--with", "channel", every=0.013)


if __name__ == "__main__":
    unittest.main()
