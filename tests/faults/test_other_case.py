"""Row 26 of docs/fault_matrix.md: a solver that was started by hand with another case than the coupler's."""
import unittest

from harness import TOP, Case, Scene
from players import SQUARE, protocol

SHORT = ("--set", "time.end=0.02")
LEVELS = """
[level.fine]
sph.spacing = 0.01
fem.block.divisions = [6, 6, 2]
"""
WALL = """
[backend.spring_wall]
origin = [-0.02, -0.02, 0]
u = [0.12, 0, 0]
v = [0, 0.12, 0]
divisions = [3, 3]
mass = 0.5
stiffness = 2e3
"""


class OtherCase(Case):
    def scene(self, more=""):
        """A scene whose case is a copy, to be edited."""
        scene = Scene()
        text = scene.case.read_text() + more
        scene.case = scene.path / "case.toml"
        scene.case.write_text(text)
        return scene

    def edit(self, scene, old, new):
        text = scene.case.read_text()
        self.assertEqual(text.count(old), 1, old)
        scene.case.write_text(text.replace(old, new))

    def test_edited_between_two_starts(self):
        """The one with the new file is refused, whoever reads the key; with the old one the run takes place."""
        with self.scene() as scene:
            scene.start_coupler(*SHORT)
            scene.wait_for_coupler()
            scene.start_solver("sph", *SHORT)
            scene.wait_until((scene.out / "sph_solver.log").exists, "sph's log, which begins when its case is read")
            self.edit(scene, "young_modulus = 1e6", "young_modulus = 2e6")
            scene.now()
            scene.start_solver("fem", *SHORT)
            says = ("fem was started with another case than the coupler: fem.material.rubber.young_modulus is 2e+06, "
                    "in the coupler's case 1e+06; start all programs with the same file")
            scene.expect("fem", 3, says, row=26)
            self.assertIn("warning: refused: " + says, scene["coupler"].said())
            self.edit(scene, "young_modulus = 2e6", "young_modulus = 1e6")
            scene.start_solver("fem", *SHORT)
            for name in ("coupler", "sph", "fem"):
                scene.expect(name, 0, within=60)

    def refuse(self, says, coupler=(), solver=(), more=""):
        with self.subTest(says), self.scene(more) as scene:
            scene.start_coupler(*coupler)
            scene.now()
            scene.start_solver("sph", *solver)
            scene.expect("sph", 3, "E_INPUT: coupler: sph was started with another case than the coupler: " + says, row=26)

    def test_another_set(self):
        self.refuse("time.max_step is 0.001, in the coupler's case not there", solver=["--set", "time.max_step=1e-3"])
        self.refuse("coupling.friction is not there, in the coupler's case 0.3", ["--set", "coupling.friction=0.3"])
        self.refuse("case.gravity is [0, 0, -1], in the coupler's case not there",
                    solver=["--set", "case.gravity=[0, 0, -1]"])
        self.refuse("sph.spacing is 0.01, in the coupler's case 0.02; start", solver=["--set", "sph.spacing=0.01"])

    def test_another_level(self):
        self.refuse("sph.spacing is 0.02, in the coupler's case 0.01 (and 1 more); start", ["--level", "fine"], more=LEVELS)

    def test_a_coupler_that_waits_in_vain_says_why(self):
        with self.scene() as scene:
            scene.start_coupler("--set", "coupling.join_timeout=5")
            scene.start_solver("sph", "--set", "time.growth=1.05")
            scene.expect("sph", 3, "time.growth")
            scene.now()
            scene.expect("coupler", 3, "nobody joined as particles, surface, sph was refused for another case,", within=6, row=26)

    def test_what_decides_no_result_may_differ(self):
        """Ends, outputs and patience; an array across lines, another order and a comment."""
        with self.scene() as scene:
            scene.start_coupler(*SHORT, "--set", "coupling.deadline=30")
            scene.wait_for_coupler()
            self.edit(scene, "end = 1000", "end = 50  # longer")
            self.edit(scene, "history_every = 2e-4", "history_every = 1e-3")
            self.edit(scene, "sound_speed = 20\n", "sound_speed = 20.0\n")
            self.edit(scene, "name = \"rubber\"\ndensity = 1500", "density = 1.5e3\nname = \"rubber\"")
            for name in ("sph", "fem"):
                scene.start_solver(name)
            for name in ("coupler", "sph", "fem"):
                scene.expect(name, 0, within=60)

    def test_a_backend_of_ours_tells_its_case_too(self):
        with self.scene(WALL) as scene:
            scene.start_coupler("--set", "fem=false", *SHORT)
            wall = ["/usr/bin/python3", TOP / "scripts/backends/spring_wall.py", scene.case, "--out", scene.out,
                    "--coupler", scene.endpoint, "--set", "fem=false"]
            scene.now()
            scene.start("fem", [*wall, "--set", "backend.spring_wall.stiffness=4e3"], log="fem_solver.log")
            scene.expect("fem", 3, "backend.spring_wall.stiffness is 4000, in the coupler's case 2000", within=5, row=26)
            scene.start("fem", wall, log="fem_solver.log")
            scene.start_solver("sph", "--set", "fem=false")
            for name in ("coupler", "sph", "fem"):
                scene.expect(name, 0, within=60)

    def test_one_that_does_not_tell_is_taken(self):
        with self.scene() as scene:
            scene.start_coupler()
            with self.assertRaises(protocol.PeerError) as told:
                protocol.Participant(scene.endpoint, "fem", "surface", join_timeout=60, case_keys=["sph.spacing = 1"])
            self.assertEqual(told.exception.code, "E_INPUT")
            link = protocol.Participant(scene.endpoint, "fem", "surface", join_timeout=60)
            link.announce(**SQUARE)
            link.report_error("E_PHYSICS", "enough")
            scene.expect("coupler", 3, "fem: enough", within=60)


if __name__ == "__main__":
    unittest.main()
