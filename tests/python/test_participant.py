"""A Python participant's life cycle, against a coupler played here byte by byte."""
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np
import zmq

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
import undertow_protocol as protocol  # noqa: E402

SESSION = 77


class Coupler:
    """Says what the test wants. One participant."""

    def __init__(self, endpoint):
        self.context = zmq.Context()
        self.socket = self.context.socket(zmq.ROUTER)
        self.socket.setsockopt(zmq.LINGER, 500)
        self.socket.setsockopt(zmq.RCVTIMEO, 10000)
        self.socket.bind(endpoint)

    def send(self, m, **keys):
        message = {"m": m, "s": SESSION, **keys}
        self.socket.send_multipart([self.peer] + protocol.encode(message))

    def receive(self, m):
        frames = self.socket.recv_multipart()
        self.peer = frames[0]
        message = protocol.decode(frames[1:])
        assert message["m"] == m, f"{message} came, type {m} was due"
        return message

    def welcome(self, **keys):
        self.receive(protocol.HELLO)
        self.send(protocol.WELCOME, **{"v": [1, 0], "caps": [], "n0": 0, "t0": 0.0, "te": 1.0,
                                       "deadline": 5.0, "share": 0.45, "max": 1 << 29, **keys})

    def acknowledge(self):
        mesh = self.receive(protocol.MESH)
        self.send(protocol.MESH_ACK, mesh=mesh["mesh"], rev=0, sum=protocol.checksum(mesh))
        return mesh

    def force(self, n, dt, t1, f, flags=0):
        self.send(protocol.FORCE, n=n, dt=dt, t1=t1, fl=flags, lim="test", f=f)

    def close(self):
        self.socket.close()
        self.context.term()


def join(endpoint, **options):
    return protocol.Participant(endpoint, "fem", "surface", "test", **{"join_timeout": 5, **options})


SQUARE = {"mesh": "wall", "groups": ["wall"], "x": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
          "mass": [1, 1, 1, 1], "quad": [[0, 1, 2, 3]], "group": [0]}


class Life(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.endpoint = "ipc://" + self.folder.name + "/coupler.sock"
        self.coupler = Coupler(self.endpoint)

    def tearDown(self):
        self.coupler.close()
        self.folder.cleanup()

    def run_solver(self, solver):
        """solver(endpoint) in a thread; returns a function that joins it and gives its result."""
        outcome = []

        def body():
            try:
                outcome.append(solver(self.endpoint))
            except Exception as error:
                outcome.append(error)

        thread = threading.Thread(target=body)
        thread.start()

        def finish():
            thread.join(20)
            self.assertTrue(outcome, "the solver did not end")
            return outcome[0]
        return finish

    def first_state(self, **welcome):
        def solver(endpoint):
            link = join(endpoint)
            link.announce(**SQUARE)
            link.send_state(0, 0.0, 1e-3, np.zeros((4, 3)), np.zeros((4, 3)))
            return link.wait_reply()
        finish = self.run_solver(solver)
        self.coupler.welcome(**welcome)
        self.coupler.acknowledge()
        self.coupler.receive(protocol.STATE)
        return finish

    def test_a_surface_session_from_hello_to_bye(self):
        def solver(endpoint):
            link = join(endpoint)
            link.announce(**SQUARE)
            t, n, forces = 0.0, 0, []
            while True:
                link.send_state(n, t, 1e-3, np.full((4, 3), n), np.zeros((4, 3)))
                reply = link.wait_reply()
                if reply.finish:
                    link.say_goodbye(n)
                    return forces, t
                forces.append(reply.force["f"][0, 2])
                t, n = reply.force["t1"], n + 1
        finish = self.run_solver(solver)
        self.coupler.welcome()
        self.coupler.acknowledge()
        t = 0.0
        for n in range(5):
            state = self.coupler.receive(protocol.STATE)
            self.assertEqual((state["n"], state["t"], state["x"][0, 0]), (n, t, n))
            t1 = t + 1e-3
            self.coupler.force(n, 1e-3, t1, np.full((4, 3), 10.0 + n))
            t = t1
        self.coupler.receive(protocol.STATE)
        self.coupler.send(protocol.FINISH, n=5, reason="done")
        self.coupler.receive(protocol.BYE)
        self.assertEqual(finish(), ([10, 11, 12, 13, 14], t))

    def test_a_particle_session_with_surface_probe_and_active(self):
        def solver(endpoint):
            link = protocol.Participant(endpoint, "sph", "particles", join_timeout=5)
            link.announce(mesh="fluid", groups=["water"], r=0.005)
            boxes = link.wait_surface()["boxes"]
            one = np.ones(3)
            link.send_probe(0, 0.0, 1e-3, id=[5, 6, 7], x=np.ones((3, 3)), v=np.zeros((3, 3)),
                            mass=one, r=one, k=one, phase=[0, 0, 0])
            reply = link.wait_reply()
            rows = list(reply.active["row"])
            link.send_state(1, reply.force["t1"], 1e-3, np.ones((2, 3)), np.zeros((2, 3)))
            link.wait_reply()
            link.say_goodbye(1)
            return boxes.shape, rows, len(reply.force["f"])
        finish = self.run_solver(solver)
        self.coupler.welcome()
        self.coupler.acknowledge()
        self.coupler.send(protocol.SURFACE, n=0, range=0.1, x=[[0, 0, 0]], quad=[], boxes=[0] * 6)
        self.assertEqual(list(self.coupler.receive(protocol.PROBE)["id"]), [5, 6, 7])
        self.coupler.send(protocol.ACTIVE, n=0, row=[0, 2])
        self.coupler.force(0, 1e-3, 1e-3, np.zeros((2, 3)))
        self.coupler.receive(protocol.STATE)
        self.coupler.send(protocol.FINISH, n=1, reason="done")
        self.coupler.receive(protocol.BYE)
        self.assertEqual(finish(), ((1, 6), [0, 2], 2))

    def check_refusal(self, finish, code):
        told = self.coupler.receive(protocol.ERROR)
        self.assertEqual((told["code"], told["who"]), (code, "fem"))
        error = finish()
        self.assertIsInstance(error, protocol.PeerError)
        self.assertEqual(error.code, code)

    def test_wrong_answers_stop_the_solver_which_tells_why(self):
        for code, force in {"E_SEQUENCE": (1, 1e-3, 1e-3, np.zeros((4, 3))),
                            "E_SHAPE": (0, 1e-3, 1e-3, np.zeros((3, 3))),
                            "E_NONFINITE": (0, 1e-3, 1e-3, np.full((4, 3), np.nan)),
                            "E_TIME": (0, 0.0, 1e-3, np.zeros((4, 3)))}.items():
            with self.subTest(code):
                finish = self.first_state()
                self.coupler.force(*force)
                self.check_refusal(finish, code)

    def test_a_message_that_is_not_due_is_refused(self):
        finish = self.first_state()
        self.coupler.send(protocol.BYE, n=0)
        self.check_refusal(finish, "E_STATE")

    def test_the_error_of_another_is_the_solvers_error(self):
        finish = self.first_state()
        self.coupler.send(protocol.ERROR, n=0, code="E_DT", text="the step collapsed", who="sph")
        error = finish()
        self.assertEqual((error.code, str(error)), ("E_DT", "sph: the step collapsed"))

    def test_a_silent_coupler_is_given_up_at_the_deadline(self):
        finish = self.first_state(deadline=0.3)
        self.check_refusal(finish, "E_TIMEOUT")

    def test_a_vanished_coupler_is_noticed_at_once(self):
        finish = self.first_state()
        start = time.monotonic()
        self.coupler.socket.close(0)
        self.assertEqual(finish().code, "E_PEER_LOST")
        self.assertLess(time.monotonic() - start, 1.0)   # a few ms; the rest is a busy machine

    def test_no_coupler_is_said_when_the_time_is_up(self):
        with self.assertRaises(protocol.PeerError) as caught:
            join("ipc://" + self.folder.name + "/nobody.sock", join_timeout=0.2)
        self.assertEqual(caught.exception.code, "E_TIMEOUT")

    def test_remote_endpoints_are_refused(self):
        with self.assertRaisesRegex(ValueError, "CURVE"):
            join("tcp://192.168.1.7:5555")


CASE = """
[backend.spring_wall]
origin = [0, 0, 0]
u = [0, 1, 0]
v = [0, 0, 1]
divisions = [2, 3]
mass = 2.0
stiffness = 800.0
damping_ratio = 0.1

[level.stiff.backend.spring_wall]
stiffness = 3200.0
"""


class SpringWall(unittest.TestCase):
    """The program itself, as a process, loaded by a constant force from t = 0."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)
        (self.path / "case.toml").write_text(CASE, encoding="ascii")
        self.endpoint = f"ipc://{self.path}/coupler.sock"
        self.coupler = Coupler(self.endpoint)

    def tearDown(self):
        self.process.kill()
        self.process.wait()
        self.process.stderr.close()
        self.coupler.close()
        self.folder.cleanup()

    def start(self, *options):
        self.process = subprocess.Popen(
            [str(ROOT / "scripts/backends/spring_wall.py"), str(self.path), "--out",
             str(self.path / "out"), "--coupler", self.endpoint, "--quiet", *options],
            stderr=subprocess.PIPE, text=True)
        self.coupler.welcome()

    def drive(self, n_steps, force, until=lambda state: False):
        f = np.zeros((12, 3))
        f[:, 0] = force / 12
        t, n = 0.0, 0
        while True:
            state = self.coupler.receive(protocol.STATE)
            if n == n_steps or until(state):
                break
            t1 = t + state["dl"] / 20
            self.coupler.force(n, state["dl"] / 20, t1, f)
            t, n = t1, n + 1
        self.coupler.send(protocol.FINISH, n=n,
                          reason="interrupted" if until(state) else "done")
        self.coupler.receive(protocol.BYE)
        return t

    def test_the_wall_overshoots_like_a_damped_oscillator(self):
        import json
        self.start()
        mesh = self.coupler.acknowledge()
        self.assertAlmostEqual(mesh["mass"].sum(), 2.0, places=12)
        corners = mesh["x"][mesh["quad"][0]]
        normal = np.cross(corners[1] - corners[0], corners[3] - corners[0])
        self.assertGreater(normal[0], 0)      # u x v, the fluid's side
        t = self.drive(8000, 8.0)
        self.assertEqual(self.process.wait(10), 0)
        summary = json.loads((self.path / "out/summary.fem.json").read_text())
        # A step load F on m, k, zeta overshoots to F/k (1 + exp(-pi zeta/sqrt(1 - zeta^2))); the
        # leapfrog's error is (omega dt)^2/24 < 1e-5 here, and the peak falls between two steps.
        expected = 0.01 * (1 + np.exp(-np.pi * 0.1 / np.sqrt(1 - 0.1 ** 2)))
        self.assertAlmostEqual(summary["displacement_max"] / expected, 1, delta=1e-4)
        self.assertAlmostEqual(summary["impulse"], 8.0 * t, places=9)
        self.assertEqual(summary["steps"], 8000)
        self.assertTrue(summary["complete"])
        # dt is constant: energies balance but for the first half kick, F^2 dt^2/(8 m), which is
        # (omega dt)^2/4 of the spring's F^2/(2 k).
        self.assertLess(summary["energy_balance_error"], (20 * 5e-5) ** 2 / 4)
        for name, columns in (("fem.history.csv", 4), ("energy.fem.csv", 6)):
            rows = np.loadtxt(self.path / "out" / name, delimiter=",", comments=("#", "t"))
            # Every 1/2000 of te = 1 s, which is every tenth of 8000 steps of 0.05 ms.
            self.assertEqual(rows.shape, (800, columns))

    def test_a_level_of_the_case_and_an_override_are_laid_over(self):
        self.start("--level", "stiff", "--set", "backend.spring_wall.mass=32.0")
        self.assertAlmostEqual(self.coupler.acknowledge()["mass"].sum(), 32.0, places=12)
        state = self.coupler.receive(protocol.STATE)
        # 0.9 * 2/omega with omega = sqrt(3200/32) = 10: more than the largest step, 1 ms.
        self.assertEqual(state["dl"], 1e-3)

    def test_ctrl_c_asks_the_coupler_to_stop(self):
        self.start()
        self.coupler.acknowledge()
        self.process.send_signal(signal.SIGINT)
        self.drive(100000, 1.0, until=lambda state: state["fl"] & protocol.STATE_STOP)
        self.assertEqual(self.process.wait(10), 130)

    def test_a_lost_coupler_ends_it_with_code_3(self):
        self.start()
        self.coupler.acknowledge()
        self.coupler.receive(protocol.STATE)
        self.coupler.socket.close(0)
        self.assertEqual(self.process.wait(10), 3)
        self.assertIn("E_PEER_LOST", (self.path / "out/fem_solver.log").read_text())


class SpringWallInput(unittest.TestCase):
    def test_a_wrong_table_is_one_sentence_and_code_2(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder)
            for text, part in {"": "is missing", CASE.replace("mass = 2.0", "mass = -1"): "mass",
                               CASE.replace("mass = 2.0", "mass = 2.0\ncolor = 1"): "color"}.items():
                (path / "case.toml").write_text(text, encoding="ascii")
                done = subprocess.run(
                    [str(ROOT / "scripts/backends/spring_wall.py"), folder, "--out", folder,
                     "--coupler", "ipc://nobody"], capture_output=True, text=True, timeout=20)
                self.assertEqual(done.returncode, 2)
                self.assertIn(part, done.stderr)


if __name__ == "__main__":
    os.environ.setdefault("PYTHONDONTWRITEBYTECODE", "1")
    unittest.main()
