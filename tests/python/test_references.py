"""References that a report.py computes itself: limits in which they are known by hand."""
import importlib.util
import pathlib
import sys
import unittest

import numpy as np

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "scripts"))

from undertow_tool.verify import slip_lines


def report_of(folder):
    spec = importlib.util.spec_from_file_location(f"report_of_{pathlib.Path(folder).name}", TOP / "cases" / folder / "report.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Heap(unittest.TestCase):
    heap = report_of("verify_sph/heap")

    def test_the_profile_holds_the_volume_it_was_asked_for(self):
        for front_height in (0.0, 0.0157):
            front = self.heap.rest_front(0.01, 0.01, front_height)
            x = np.linspace(0, front, 20001)
            h = self.heap.rest_profile(0.5 * (x[1:] + x[:-1]), front, 0.01, front_height)
            self.assertAlmostEqual(np.sum(h) * (x[1] - x[0]), 0.01, delta=2e-8)     # midpoints, root at the front

    def test_leading_order_is_three_halves_of_the_volume(self):
        front = self.heap.rest_front(0.02, 100 / (1600 * 9.81), 0.0)
        self.assertAlmostEqual(front, 0.413, delta=5e-4)                            # docs/theory.md

    def test_the_tension_shortens_the_runout(self):
        Y = 100 / (1600 * 9.81)
        self.assertAlmostEqual(self.heap.rest_front(0.02, Y, 0.5 * np.pi * Y), 0.362, delta=5e-4)


class LockExchange(unittest.TestCase):
    lock = report_of("verify_sph/lock_exchange")

    def test_half_the_depth_loses_no_energy(self):
        self.assertAlmostEqual(self.lock.benjamin(0.5), 0.5, places=12)

    def test_equal_densities_have_equal_fronts(self):
        depth, speed = self.lock.dense_front(0.999)
        self.assertAlmostEqual(depth, 0.5, delta=2e-3)
        self.assertAlmostEqual(speed, 0.5, delta=1e-3)

    def test_the_denser_the_faster_and_thinner(self):
        found = [self.lock.dense_front(ratio) for ratio in (0.9, 0.6, 0.3)]
        self.assertTrue(found[0][0] > found[1][0] > found[2][0])
        self.assertTrue(found[0][1] < found[1][1] < found[2][1])


class SlipLines(unittest.TestCase):
    def test_constant_strength_is_prandtl(self):
        for load in (slip_lines.smooth_load, slip_lines.rough_load):
            self.assertAlmostEqual(load(0.0, 10), 2 + np.pi, places=12)
            value, doubt = slip_lines.converged(load, 1e-3, 10)      # and as the limit of little growth
            self.assertAlmostEqual(value, 2 + np.pi, delta=3e-3)
            self.assertLess(doubt, 1e-4)

    def test_a_step_is_of_second_order(self):
        for load in (slip_lines.smooth_load, slip_lines.rough_load):
            coarse, middle, fine = (load(1.0, steps) for steps in (10, 20, 40))
            self.assertAlmostEqual((coarse - middle) / (middle - fine), 4, delta=0.8)

    def test_strength_that_begins_at_nothing_bears_a_quarter_of_that_of_the_width(self):
        # Davis and Booker 1973: q = k B/4 under a smooth footing without s_0; here steps are of first order
        coarse, fine = (slip_lines.smooth_load(1e6, steps) / 0.25e6 for steps in (40, 80))
        self.assertTrue(coarse > fine > 1)
        self.assertAlmostEqual(2 * fine - coarse, 1, delta=0.06)

    def test_mechanisms_bear_more(self):
        # upper bound of Hill's and Prandtl's mechanisms, whose depths are B/2 sqrt 2 and B sqrt 2 over 2
        for ratio in (0.5, 1.0, 4.0):
            smooth, rough = slip_lines.smooth_load(ratio, 20), slip_lines.rough_load(ratio, 20)
            self.assertLess(smooth, 2 + np.pi + ratio)
            self.assertLess(rough, min(2 + np.pi + 2 * ratio, 3 + np.pi + ratio))
            self.assertLess(smooth, rough)


class WaveMaker(unittest.TestCase):
    wave = report_of("wave_maker")

    def test_long_waves_displace_what_the_wave_maker_sweeps(self):
        theory = self.wave.LinearTheory(0.4, 60.0, 9.81)
        kh = theory.k * theory.depth
        self.assertAlmostEqual(theory.transfer(flap=False) / kh, 1, delta=1e-3)
        self.assertAlmostEqual(theory.transfer(flap=True) / (0.5 * kh), 1, delta=1e-3)
        self.assertAlmostEqual(theory.group_speed(), np.sqrt(9.81 * 0.4), delta=2e-3)

    def test_short_waves_are_twice_the_stroke_of_either(self):
        theory = self.wave.LinearTheory(10.0, 1.0, 9.81)
        self.assertAlmostEqual(theory.transfer(flap=False), 2, delta=1e-6)
        self.assertAlmostEqual(theory.transfer(flap=True), 2, delta=0.06)           # 2 (1 - 1/kh), kh = 40

    def test_a_harmonic_is_found_beside_mean_and_overtones(self):
        t = np.arange(0, 6, 0.02)
        omega = 2 * np.pi / 1.4
        values = 0.4 + 0.03 * np.cos(omega * t - 0.7) + 0.01 * np.cos(2 * omega * t)
        found = self.wave.harmonic(t, values, omega, (3.2, 6.0))
        self.assertAlmostEqual(abs(found), 0.03, places=10)
        self.assertAlmostEqual(np.angle(found), -0.7, places=10)


if __name__ == "__main__":
    unittest.main()
