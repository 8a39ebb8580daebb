"""What row 17 of docs/fault_matrix.md is for checkpoints, for fields and histories: the disk is full.
The program says so, the others learn it, and all that was written before is whole. Also: killed at
any moment, a program leaves files that open."""
import random
import resource
import signal
import time
import unittest

from harness import Case, Scene


def limit_files(size):
    """In the child: no file of its grows beyond `size` [byte], a full disk for one program."""
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
    return limit


class FullDisk(Case):
    def fill(self, who, others, size, says, *settings, outputs=3):
        with Scene() as scene:
            scene.start_coupler(*settings, before=limit_files(size) if who == "coupler" else None)
            for name in ("sph", "fem"):
                scene.start_solver(name, *settings, before=limit_files(size) if who == name else None)
            scene.wait_until(lambda: scene[who].process.poll() is not None, "the end of the disk")
            scene.now()
            scene.expect(who, 2, "check that", row=17)
            scene.expect(who, 2, says)
            for name in others:
                scene.expect(name, 3, "E_IO", row=17)
            scene.expect_output_whole(outputs)

    def test_fields_of_the_particles(self):
        self.fill("sph", ("coupler", "fem"), 1_000_000, "sph.vtkhdf")

    def test_fields_of_the_structure(self):
        self.fill("fem", ("coupler", "sph"), 1_000_000, "fem.vtkhdf")

    def test_histories_of_the_coupler(self):
        self.fill("coupler", ("sph", "fem"), 600_000, ".csv",
                  "--set", "output.fields_every=100", "--set", "output.history_every=1e-6", outputs=1)

    def test_histories_of_a_solver(self):
        often = ("--set", "output.fields_every=100", "--set", "output.history_every=1e-6")
        with Scene() as scene:
            scene.start_coupler("--set", "output.fields_every=100")
            scene.start_solver("sph", *often)
            scene.start_solver("fem", *often, before=limit_files(600_000))
            scene.wait_until(lambda: scene["fem"].process.poll() is not None, "the end")
            scene.now()
            scene.expect("fem", 2, "fem.history.csv could not be written", row=17)
            for name in ("coupler", "sph"):
                scene.expect(name, 3, "E_IO", row=17)
            scene.expect_output_whole()

    def test_killed_at_any_moment(self):
        moment = random.Random(17)
        for turn in range(12):
            with self.subTest(turn), Scene() as scene:
                scene.start_trio("--set", "output.fields_every=5e-4")
                scene.wait_for_outputs(6)       # by then 5 of them are whole
                time.sleep(moment.random())
                for name in ("sph", "fem", "coupler"):
                    scene[name].signal(signal.SIGKILL)
                for name in ("sph", "fem", "coupler"):
                    scene[name].process.wait()
                scene.expect_output_whole(5)


if __name__ == "__main__":
    unittest.main()
