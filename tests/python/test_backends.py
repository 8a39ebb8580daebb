"""The Python backends: against theory as programs pushed by a played coupler, and some steps of a
whole case against the real one."""
import importlib.util
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("UNDERTOW_BUILD", ROOT / "build"))
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "scripts/backends"), str(pathlib.Path(__file__).parent)]
import undertow_protocol as protocol  # noqa: E402
from backend import Table  # noqa: E402
from beam import Beam  # noqa: E402
from rigid_body import RigidBody, rotation, rotation_vector  # noqa: E402
from test_participant import Coupler  # noqa: E402

PLATE = {"origin": [0, 0, 0], "span": [0, 0, 0.6], "width": [0, 0.15, 0], "divisions": [8, 2],
         "ends": ["clamped", "free"], "thickness": 0.02, "density": 1190, "young_modulus": 3.2e9}
BLOCK = {"box": [0, 0, 0, 0.1, 0.2, 0.3], "divisions": [1, 2, 3], "mass": 12.0,
         "stiffness": [2e5, 3e5, 4e5], "rocking": [3e3, 2e3, 1e3]}


def beam(**keys):
    return Beam(Table("beam", {**PLATE, **keys}))


def block(**keys):
    return RigidBody(Table("rigid_body", {**BLOCK, **keys}))


def frequency(signal, dt):
    """[Hz] of a swing about zero, from its first and last upward crossing."""
    up = np.flatnonzero((signal[:-1] < 0) & (signal[1:] >= 0))
    at = up + signal[up] / (signal[up] - signal[up + 1])
    return (len(at) - 1) / (dt * (at[-1] - at[0]))


class BeamTheory(unittest.TestCase):
    def test_frequencies_of_three_supports(self):
        """(beta L)^2 sqrt(E I/(rho A))/L^2, beta L = 1.87510, 4.73004, pi [Euler-Bernoulli]; eight
        cubic elements: the error of mode 1 is (beta h)^4/720 < 2e-5."""
        for ends, root in ((["clamped", "free"], 1.875104069), (["clamped", "clamped"], 4.730040745),
                           (["pinned", "pinned"], np.pi)):
            exact = root**2 * np.sqrt(3.2e9 * 0.02**2 / 12 / 1190) / 0.6**2
            self.assertAlmostEqual(beam(ends=ends).omega[0] / exact, 1, delta=3e-4 * (root > 4) + 2e-5)

    def test_a_tip_load_bends_it_by_F_L3_over_3_E_I(self):
        wall, rows = beam(damping_ratio=1.0, largest_step=1e-3), np.zeros((27, 3))
        rows[-3:, 0] = -10 / 3      # the normal is -x: span x width
        for _ in range(3000):
            wall.step(rows, 1e-3)
        exact = 10 * 0.6**3 / (3 * 3.2e9 * 0.15 * 0.02**3 / 12)
        self.assertAlmostEqual(wall.shown[0] / exact, 1, delta=1e-6)
        # At most what the first half kick leaves, F^2 dt^2/(8 m) of each mode [test_participant].
        loads = wall.shapes[-1] * 10
        first = (loads**2 / 0.15 * 1e-6 / 8 / (1 + 0.25e-6 * wall.omega**2)).sum()
        self.assertLess(abs(wall.energies()[4]), first)

    def test_steps_far_above_the_highest_mode_are_stable_and_slow_the_first_as_said(self):
        wall = beam()
        dt = 1 / wall.omega[0]
        self.assertGreater(dt * wall.omega[-1], 100)
        wall.q[0] = 1e-3
        tip = []
        for _ in range(2000):
            wall.step(np.zeros((27, 3)), dt)
            tip.append(wall.shown[0])
        self.assertAlmostEqual(max(tip[1000:]) / max(tip[:1000]), 1, delta=0.01)
        # omega' from cos(omega' dt) = 1 - (omega dt)^2/2/(1 + (omega dt)^2/4), of the three levels
        slowed = np.arccos(1 - 0.5 / 1.25) / dt / 2 / np.pi
        self.assertAlmostEqual(frequency(np.array(tip), dt) / slowed, 1, delta=1e-3)

    def test_loose_beams_do_not_feel_each_other(self):
        wall, rows = beam(across="loose"), np.zeros((27, 3))
        rows[1::3, 0] = -1.0        # on the middle line
        wall.step(rows, 1e-4)
        moved = np.abs(wall.positions() - wall.x0).sum(axis=1).reshape(9, 3)
        self.assertEqual(moved[:, [0, 2]].max(), 0)
        self.assertGreater(moved[-1, 1], 0)

    def test_wrong_tables_are_refused_by_their_key(self):
        from backend import InputError
        for keys, part in (({"ends": ["free", "free"]}, "free to fly"), ({"thickness": 0}, "thickness"),
                           ({"poisson_ratio": 0.5}, "poisson_ratio"), ({"across": "x"}, "across"),
                           ({"divisions": [0, 1]}, "divisions")):
            with self.assertRaisesRegex(InputError, part):
                beam(**keys)


class RigidBodyTheory(unittest.TestCase):
    def test_its_modes_are_those_of_a_block_on_springs(self):
        body = block()
        # vertical and torsion stand alone; sway and rocking are coupled: here by the 2 x 2 by hand
        inertia = 12 / 12 * np.array([0.2**2 + 0.3**2, 0.1**2 + 0.3**2, 0.1**2 + 0.2**2])
        exact = [4e5 / 12, 1e3 / inertia[2]]
        for k, rocking, about in ((2e5, 2e3, 1), (3e5, 3e3, 0)):
            h = 0.15
            a, b, c = k / 12, (rocking + k * h * h) / inertia[about], k * k * h * h / 12 / inertia[about]
            root = np.sqrt((a - b)**2 / 4 + c)
            exact += [(a + b) / 2 - root, (a + b) / 2 + root]
        np.testing.assert_allclose(body.omega, np.sqrt(np.sort(exact)), rtol=1e-12)

    def test_it_swings_at_its_frequencies(self):
        for axis in (2, 5):         # up and down; about z
            body = block()
            omega = np.sqrt(4e5 / 12) if axis == 2 else np.sqrt(1e3 / body.inertia[2])
            if axis == 2:
                body.u[2] = 1e-4
            else:
                body.turn = rotation(np.array([0, 0, 1e-4]))
            dt = 0.1 / omega
            swing = []
            for _ in range(3000):
                body.step(np.zeros((len(body.x0), 3)), dt)
                swing.append(body.shown[axis])
            # leapfrog: sin(omega' dt/2) = omega dt/2
            exact = 2 / dt * np.arcsin(0.05) / 2 / np.pi
            self.assertAlmostEqual(frequency(np.array(swing), dt) / exact, 1, delta=1e-5)
            self.assertAlmostEqual(max(swing[-200:]) / 1e-4, 1, delta=0.01)

    def test_a_free_spin_keeps_momentum_and_energy(self):
        body = block(stiffness=[0, 0, 0], rocking=[0, 0, 0], inertia=[1.0, 2.0, 3.0])
        body.momentum = np.array([0.02, 2.0, 0.05])         # about the middle axis: it tumbles
        energies, directions = [], []
        for _ in range(20000):
            body.step(np.zeros((len(body.x0), 3)), 1e-3)
            energies.append(body.kinetic)
            directions.append(body.turn[1, 1])
        self.assertLess(min(directions), -0.9)
        self.assertLess(np.ptp(energies) / energies[0], 1e-3)   # (omega dt)^2 and its half step
        np.testing.assert_allclose(body.turn @ body.turn.T, np.eye(3), atol=1e-10)

    def test_a_rotation_and_its_vector(self):
        theta = np.array([0.3, -1.1, 0.7])
        np.testing.assert_allclose(rotation_vector(rotation(theta)), theta, atol=1e-14)

    def test_the_faces_look_outward_and_close(self):
        body = block()
        p = body.x0[body.quad]
        area = 0.5 * np.cross(p[:, 2] - p[:, 0], p[:, 3] - p[:, 1])
        volume = (area * p.mean(axis=1)).sum() / 3
        self.assertAlmostEqual(volume, 0.1 * 0.2 * 0.3, places=12)
        np.testing.assert_allclose(area.sum(axis=0), 0, atol=1e-15)


@unittest.skipUnless(importlib.util.find_spec("getfem") and importlib.util.find_spec("scipy"),
                     "needs python3-getfem and python3-scipy")
class GetfemTheory(unittest.TestCase):
    PLATE = {"box": [0, 0, 0, 0.02, 0.15, 0.6], "divisions": [1, 2, 12], "wet": "xmin", "held": ["zmin"],
             "density": 1190, "young_modulus": 3.2e9, "poisson_ratio": 0}

    def wall(self, **keys):
        from getfem_wall import GetfemWall
        return GetfemWall(Table("getfem_wall", {**self.PLATE, **keys}))

    def test_the_first_frequency_of_a_cantilever(self):
        """1.87510^2 sqrt(E I/(rho A))/L^2; shear and rotation slow it by about (h/L)^2 = 1e-3 at most."""
        exact = 1.875104069**2 * np.sqrt(3.2e9 * 0.02**2 / 12 / 1190) / 0.6**2
        self.assertAlmostEqual(self.wall().omega / exact, 1, delta=1e-3)

    def test_a_tip_load_bends_it_by_F_L3_over_3_E_I_and_energy_balances(self):
        wall = self.wall(probe=[0, 0.075, 0.6])
        wall.damping = 2 * wall.omega
        h, rows = wall.stable_step(0.45), np.zeros_like(wall.x0)
        tip = np.isclose(wall.x0[:, 2], 0.6)
        rows[tip, 0] = 10 / tip.sum()
        for _ in range(1000):
            wall.step(rows, h)
        exact = 10 * 0.6**3 / (3 * 3.2e9 * 0.15 * 0.02**3 / 12)
        self.assertAlmostEqual(wall.shown[0] / exact, 1, delta=2e-3)   # shear: E/(4 G) (h/L)^2 = 6e-4
        _, internal, _, work, error = wall.energies()
        mean = wall.full(wall.u)[tip, 0].mean()
        self.assertAlmostEqual(internal, 0.5 * 10 * mean, delta=1e-6 * internal)
        self.assertLess(abs(error), 0.01 * work)        # what the first half kick leaves

    def test_a_mode_slows_as_said_whatever_the_step(self):
        wall = self.wall(largest_step=2.0 / self.wall().omega)
        dt = wall.stable_step(0.0)
        h = dt / 0.9
        from scipy.sparse.linalg import eigsh
        from scipy import sparse
        mass = wall.mass[wall.free]
        _, shape = eigsh(wall.k_free, 1, sparse.diags(mass), sigma=0)
        wall.u = 1e-4 * shape[:, 0]
        along, nothing = [], np.zeros_like(wall.x0)
        for _ in range(400):
            wall.step(nothing, dt)
            along.append(float(shape[:, 0] @ (mass * wall.u)))
        omega2 = wall.omega**2 / (1 + 0.25 * (wall.omega * h)**2)
        slowed = np.arccos(1 - 0.5 * omega2 * dt * dt) / dt / 2 / np.pi
        self.assertAlmostEqual(frequency(np.array(along), dt) / slowed, 1, delta=1e-3)

    def test_the_wet_face_looks_outward_and_carries_its_share_of_the_mass(self):
        for face, normal in (("xmin", [-1, 0, 0]), ("ymax", [0, 1, 0]), ("zmax", [0, 0, 1])):
            with self.subTest(face):
                wall = self.wall(wet=face)
                p = wall.x0[wall.quad]
                area = 0.5 * np.cross(p[:, 2] - p[:, 0], p[:, 3] - p[:, 1])
                self.assertTrue((area @ normal > 0).all())
                self.assertAlmostEqual(wall.mass.sum() / 3, 1190 * 0.02 * 0.15 * 0.6, places=9)
                self.assertTrue((wall.nodal_mass > 0).all())


class Programs(unittest.TestCase):
    """As a user starts them: some steps of the dam break, with the programs of the build."""

    def run_case(self, backend, *options):
        with tempfile.TemporaryDirectory(prefix="undertow-") as folder:
            out = pathlib.Path(folder) / "out"
            ran = subprocess.run(
                [ROOT / "scripts/undertow", "run", "cases/dam_break", "--level", "quick", "--backend",
                 f"scripts/backends/{backend}.py", "--set", "time.end=0.004", "--set",
                 "sph.fill=[{fluid = \"water\", box = {min = [1.31, 0, 0], max = [1.61, 0.15, 0.3]}}]",
                 "--set", "sph.body=false", "--out", out, "--quiet", *options], cwd=ROOT, text=True,
                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=100,
                env={**os.environ, "UNDERTOW_BUILD": str(BUILD), "OMP_NUM_THREADS": "1"})
            self.assertEqual(ran.returncode, 0, ran.stdout)
            summary = json.loads((out / "summary.fem.json").read_text())
            rows = np.loadtxt(out / "fem.history.csv", delimiter=",", comments=("#", "t"))
            return summary, rows

    def check(self, summary, rows):
        self.assertTrue(summary["complete"])
        self.assertGreater(summary["steps"], 10)
        self.assertGreater(summary["max_displacement"], 0)
        self.assertGreater(summary["force_max"], 1)        # water at rest against the wall: 66 N
        self.assertGreater(len(rows), 10)

    def test_the_beam_under_standing_water(self):
        self.check(*self.run_case("beam"))

    def test_the_block_under_standing_water(self):
        self.check(*self.run_case("rigid_body"))

    @unittest.skipUnless(importlib.util.find_spec("getfem") and importlib.util.find_spec("scipy"),
                         "needs python3-getfem and python3-scipy")
    def test_getfem_under_standing_water(self):
        summary, rows = self.run_case("getfem_wall")
        self.check({**summary, "max_displacement": summary["probe_displacement_max"]}, rows)

    def test_the_spring_wall_under_standing_water(self):
        self.check(*self.run_case("spring_wall"))


if __name__ == "__main__":
    unittest.main()
