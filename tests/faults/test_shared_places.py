"""Rows 11, 15 and 16 of docs/fault_matrix.md: two of a kind, and what a dead run left behind."""
import os
import signal
import unittest

from harness import Case, Scene
from players import protocol


class SharedPlaces(Case):
    def test_a_name_that_is_taken_and_one_that_comes_late(self):
        with Scene("dummies") as scene:
            coupler = scene.start_coupler()
            scene.start_dummy("particles", "--height", "1")
            scene.wait_for_join("sph")
            scene.now()
            scene.start_dummy("particles", name="again")
            scene.expect("again", 3, "E_NAME_TAKEN", within=3, row=11)
            scene.start_dummy("surface")
            scene.wait_for_step(10)
            with self.assertRaises(protocol.PeerError) as told:
                protocol.Participant(scene.endpoint, "third", "surface", join_timeout=5)
            self.assertEqual(told.exception.code, "E_LATE")
            scene.wait_for_step(scene.status()["step"] + 100)     # the run does not notice
            scene.now()
            coupler.signal(signal.SIGTERM)
            for name in ("coupler", "sph", "fem"):      # 130: stopped by its user
                scene.expect(name, 130, row=11)

    def test_two_couplers_on_one_endpoint(self):
        with Scene("dummies") as scene:
            first = scene.start_coupler()
            scene.start_dummy("particles", "--height", "1")
            scene.start_dummy("surface")
            scene.wait_for_step(10)
            other = scene.path / "other"
            other.mkdir()
            scene.now()
            scene.start_coupler(name="second", out=other)
            scene.expect("second", 3, f"is in use by process {first.process.pid}", row=15)
            step = scene.status()["step"]
            scene.wait_for_step(step + 100)             # the first one runs on

    def test_two_couplers_on_one_port(self):
        with Scene("dummies") as scene:
            scene.endpoint = "tcp://127.0.0.1:0"
            scene.start_coupler()
            scene.wait_until(lambda: "tcp://127.0.0.1:" in scene["coupler"].said(), "the port")
            scene.endpoint = scene["coupler"].said().split("at ")[1].split()[0]
            scene.now()
            scene.start_coupler(name="second", out=scene.path / "other")
            scene.expect("second", 3, "Address already in use", row=15)

    def test_the_socket_and_the_lock_of_a_dead_run(self):
        with Scene("dummies") as scene:
            scene.start_coupler()
            scene.wait_for_coupler()
            scene["coupler"].kill()
            scene["coupler"].wait(5)
            left = sorted(os.listdir(scene.path / "socket"))
            self.assertEqual(left, ["coupler.sock", "coupler.sock.lock"])
            scene.start_coupler("--set", "time.end=0.01")
            scene.start_dummy("particles", "--height", "1")
            scene.start_dummy("surface")
            scene.now()
            for name in ("coupler", "sph", "fem"):      # 130: stopped by its user
                scene.expect(name, 0, within=5, row=16)
            self.assertEqual(os.listdir(scene.path / "socket"), [])


if __name__ == "__main__":
    unittest.main()
