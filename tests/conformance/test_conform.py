"""`undertow conform` against everything here that joins a coupler, over every transport; and against one
that does not keep to the protocol, which it must find out."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

TOP = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("UNDERTOW_BUILD", TOP / "build")) / "bin"
PYTHON = "/usr/bin/python3"
PLATE = TOP / "tests" / "faults" / "water_on_plate.toml"
DAM_BREAK = TOP / "cases" / "dam_break"
ENVIRONMENT = {**os.environ, "OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive", "PYTHONDONTWRITEBYTECODE": "1"}


def conform(endpoint, *options, participant):
    done = subprocess.run([PYTHON, TOP / "scripts" / "undertow", "conform", endpoint, *options, "--",
                           *map(str, participant)], capture_output=True, text=True, env=ENVIRONMENT, check=False)
    return done.returncode, done.stdout + done.stderr


class Conformance(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory(prefix="undertow-")
        self.out = pathlib.Path(self.scratch.name) / "results"
        self.addCleanup(self.scratch.cleanup)

    def expect_all(self, endpoint, *options, participant, least):
        code, said = conform(endpoint, *options, participant=participant)
        self.assertEqual(code, 0, said)
        passed = int(re.search(r"^(\d+) passed, 0 failed", said, re.M)[1])
        self.assertGreaterEqual(passed, least, said)
        return said


class Fast(Conformance):
    def test_the_smallest_backend_by_all_transports(self):
        for endpoint, options in (("ipc", []), ("ipc", ["--shm"]), ("tcp", [])):
            with self.subTest(endpoint=endpoint, options=options):
                self.expect_all(endpoint, *options, participant=[BIN / "minimal_backend", "{endpoint}"], least=55)

    def test_a_participant_without_checks_is_found_out(self):
        page = (TOP / "docs" / "protocol.md").read_text(encoding="utf-8")
        script = pathlib.Path(self.scratch.name) / "skeleton.py"
        script.write_text(re.search(r"```python\n(import sys, msgpack.*?)```", page, re.S)[1])
        code, said = conform("ipc", "--only", "20 steps|half a step|NaN|another checksum|fault_trailing|later",
                             participant=[PYTHON, script, "{endpoint}"])
        self.assertEqual(code, 1, said)
        verdicts = dict((line[7:].split("  [")[0].split(":")[0], line.split()[0])
                        for line in said.splitlines() if line[:7].strip() in ("ok", "FAILED"))
        self.assertEqual(verdicts["20 steps"], "ok", said)          # it can take steps,
        self.assertEqual(verdicts["the first kick is half a step"], "ok", said)
        self.assertEqual(verdicts["FORCE with a NaN"], "FAILED", said)  # but believes everything
        self.assertEqual(verdicts["MESH_ACK with another checksum"], "FAILED", said)

    def test_a_program_that_does_not_come_is_named(self):
        code, said = conform("ipc", participant=[BIN / "minimal_backend", "nowhere", "{endpoint}"])
        self.assertEqual(code, 2)
        self.assertIn("usage: minimal_backend ENDPOINT", said)

    def test_a_recorded_run_is_played_to_any_backend(self):
        recorded = subprocess.run(
            [PYTHON, TOP / "scripts" / "undertow", "run", PLATE, "--set", "time.end=0.01", "--record", "--quiet",
             "--out", self.out], capture_output=True, text=True, env=ENVIRONMENT, check=False)
        self.assertEqual(recorded.returncode, 0, recorded.stdout + recorded.stderr)
        for who in ("sph", "fem"):
            said = self.expect_all(
                "ipc", "--recording", self.out / f"recording.{who}.utow", "--only", "plays", least=1,
                participant=[BIN / f"{who}_solver", PLATE, "--set", "time.end=0.01", "--out", self.out / "again",
                             "--coupler", "{endpoint}", "--threads", "1", "--quiet"])
            self.assertIn("all as recorded in every bit", said)
            replayed = subprocess.run([PYTHON, TOP / "scripts" / "undertow", "replay", self.out, who],
                                      capture_output=True, text=True, env=ENVIRONMENT, check=False)
            self.assertEqual(replayed.returncode, 0, replayed.stderr)
            self.assertIn("every message is the recorded one, bit by bit", replayed.stdout)
            self.assertIn("overhead of the coupling", replayed.stdout)


class Whole(Conformance):
    """Minutes: the solvers and the Python backends."""

    def test_the_solvers(self):
        for who, least in (("fem", 55), ("sph", 54)):
            for endpoint, options in (("ipc", []), ("ipc", ["--shm"]), ("tcp", [])):
                with self.subTest(who=who, endpoint=endpoint, options=options):
                    self.expect_all(endpoint, *options, least=least, participant=[
                        BIN / f"{who}_solver", PLATE, "--out", self.out, "--coupler", "{endpoint}", "--threads", "1",
                        "--quiet"])

    def test_the_python_backends(self):
        for name, endpoint in (("spring_wall", "ipc"), ("beam", "tcp"), ("rigid_body", "ipc")):
            with self.subTest(name):
                self.expect_all(endpoint, least=54, participant=[
                    PYTHON, TOP / "scripts" / "backends" / f"{name}.py", DAM_BREAK, "--out", self.out, "--coupler",
                    "{endpoint}"])


if __name__ == "__main__":
    sys.exit(unittest.main())
