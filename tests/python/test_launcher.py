"""The launcher: it starts the programs, passes their exit codes, and ends them together."""
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import textwrap
import threading
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))

from undertow_tool import launch  # noqa: E402
from undertow_tool.launch import Child, Watch, first_failure, split_threads  # noqa: E402


def program(folder, name, body):
    """A stand-in for a solver: a Python script that logs its lines to NAME.log."""
    path = pathlib.Path(folder) / f"{name}.py"
    path.write_text("import os, signal, sys, time\n" + textwrap.dedent(body))
    return Child(name, ["/usr/bin/python3", str(path)], 1)


class WatchTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.out = pathlib.Path(self.folder.name)
        self.environment = launch.environment
        launch.environment = lambda threads, spin: dict(os.environ)     # needs no built programs

    def tearDown(self):
        launch.environment = self.environment
        self.folder.cleanup()

    def child(self, name, body):
        return program(self.out, name, body)

    def test_all_done_is_code_zero(self):
        coupler = self.child("coupler", "time.sleep(0.5)")
        outcome = Watch([coupler, self.child("sph_solver", "time.sleep(0.4)")], self.out).run()
        self.assertEqual(outcome.code, 0)
        self.assertIsNone(outcome.failed)

    def test_the_program_that_failed_by_itself_is_the_cause(self):
        # The coupler notices the loss and ends first; the cause is still the physics of the solver.
        coupler = self.child("coupler", "time.sleep(0.1); sys.exit(3)")
        fem = self.child("fem_solver", "time.sleep(0.4); sys.exit(4)")
        sph = self.child("sph_solver", "time.sleep(0.1); sys.exit(3)")
        outcome = Watch([coupler, sph, fem], self.out).run()
        self.assertEqual(outcome.code, 4)
        self.assertEqual(outcome.failed.name, "fem_solver")

    def test_a_crash_is_a_lost_peer(self):
        crash = self.child("sph_solver", "os.kill(os.getpid(), signal.SIGSEGV)")
        outcome = Watch([self.child("coupler", "time.sleep(0.3); sys.exit(3)"), crash], self.out).run()
        self.assertEqual(outcome.code, 3)
        self.assertEqual(outcome.failed.name, "sph_solver")
        self.assertIn("signal 11", launch.how_it_ended(outcome.failed))

    def test_the_others_are_ended_when_one_dies(self):
        saved, launch.GRACE, launch.GRACE_TERMINATE = (launch.GRACE, launch.GRACE_TERMINATE), 0.3, 0.3
        try:
            deaf = self.child("fem_solver", "signal.signal(signal.SIGTERM, signal.SIG_IGN); time.sleep(60)")
            started = time.monotonic()
            outcome = Watch([deaf, self.child("sph_solver", "time.sleep(0.2); sys.exit(2)")], self.out).run()
            self.assertLess(time.monotonic() - started, 10)
            self.assertEqual(outcome.code, 2)
            self.assertEqual(deaf.code, -signal.SIGKILL)
        finally:
            launch.GRACE, launch.GRACE_TERMINATE = saved

    def test_the_first_interrupt_goes_to_the_coupler_alone(self):
        coupler = self.child("coupler", f"""
            def stop(*_):
                open({str(self.out / 'finish')!r}, "w").close()
                sys.exit(130)
            signal.signal(signal.SIGINT, stop)
            open({str(self.out / 'ready')!r}, "w").close()
            time.sleep(60)""")
        solver = self.child("sph_solver", f"""
            signal.signal(signal.SIGINT, lambda *_: sys.exit(9))
            while not os.path.exists({str(self.out / 'finish')!r}):
                time.sleep(0.02)""")

        def interrupt():
            while not (self.out / "ready").exists():
                time.sleep(0.02)
            os.kill(os.getpid(), signal.SIGINT)

        threading.Thread(target=interrupt, daemon=True).start()
        outcome = Watch([coupler, solver], self.out).run()
        self.assertEqual(outcome.code, 130)
        self.assertEqual(solver.code, 0)       # followed in good order, without a signal

    def test_the_second_interrupt_ends_all(self):
        deaf = self.child("coupler", f"""
            signal.signal(signal.SIGINT, signal.SIG_IGN)
            open({str(self.out / 'ready')!r}, "w").close()
            time.sleep(60)""")

        def interrupt():
            while not (self.out / "ready").exists():
                time.sleep(0.02)
            for _ in range(2):
                os.kill(os.getpid(), signal.SIGINT)
                time.sleep(0.3)

        threading.Thread(target=interrupt, daemon=True).start()
        outcome = Watch([deaf], self.out).run()
        self.assertEqual(outcome.code, 130)
        self.assertEqual(deaf.code, -signal.SIGTERM)

    def test_last_words_are_the_end_of_the_log(self):
        (self.out / "sph_solver.log").write_text("".join(f"line {i}\n" for i in range(50)))
        (self.out / "sph_solver.stderr").write_text("sph_solver: error: line 49\nTraceback of a crash\n")
        (log, lines), (printed, beside) = launch.last_words(Child("sph_solver", [], 1), self.out)
        self.assertEqual(log.name, "sph_solver.log")
        self.assertEqual(lines, [f"line {i}" for i in range(40, 50)])
        self.assertEqual(printed.name, "sph_solver.stderr")
        self.assertEqual(beside, ["Traceback of a crash"])


    def test_what_was_told_to_end_is_not_the_cause(self):
        # The solver failed with a peer's code, another one that was asked to end with that of an interrupt.
        settles = self.child("sph_solver", "signal.signal(signal.SIGTERM, lambda *_: sys.exit(130)); time.sleep(60)")
        saved, launch.GRACE_ALONE = launch.GRACE_ALONE, 0
        try:
            outcome = Watch([settles, self.child("fem_solver", "time.sleep(0.2); sys.exit(3)")], self.out).run()
        finally:
            launch.GRACE_ALONE = saved
        self.assertEqual((outcome.code, outcome.failed.name, settles.code), (3, "fem_solver", 130))

    def test_a_solver_that_nobody_waits_for_is_asked_to_end(self):
        coupler = self.child("coupler", "time.sleep(0.1); sys.exit(2)")
        settles = self.child("fem_solver", "signal.signal(signal.SIGTERM, lambda *_: sys.exit(130)); time.sleep(60)")
        saved, launch.GRACE = launch.GRACE, 1000        # so that no force ends it
        try:
            outcome = Watch([coupler, settles], self.out).run()
        finally:
            launch.GRACE = saved
        self.assertEqual((outcome.code, outcome.failed.name, settles.code), (2, "coupler", 130))

    def test_a_program_that_cannot_be_started_is_said_so(self):
        coupler = self.child("coupler", "signal.sigwait([signal.SIGUSR1]); sys.exit(3)")
        outcome = Watch([coupler, Child("fem_solver", ["/nonexistent/solver"], 1)], self.out).run()
        self.assertEqual((outcome.code, outcome.failed.name), (2, "fem_solver"))
        (_, lines), = launch.last_words(outcome.failed, self.out)
        self.assertEqual(lines, ["/nonexistent/solver cannot be started: No such file or directory."])


    def test_warnings_are_told_once_each_and_only_those(self):
        (self.out / "sph_solver.log").write_text("2026 sph_solver info: a warning: none\n" + "2026 sph_solver warning: too soft\n" * 3
                                                 + "2026 sph_solver warning: too fast\n")
        self.assertEqual(launch.warnings_of(Child("sph_solver", [], 1), self.out), ["too soft", "too fast"])
        self.assertEqual(launch.warnings_of(Child("coupler", [], 1), self.out), [])


class PlanTest(unittest.TestCase):
    def test_threads_go_to_the_particle_solver(self):
        self.assertEqual(split_threads(8, ["coupler", "sph_solver", "fem_solver"]),
                         {"coupler": 1, "sph_solver": 8, "fem_solver": 1})
        self.assertEqual(split_threads(8, ["fem_solver"]), {"fem_solver": 8})

    def test_no_failure_has_no_cause(self):
        done = Child("coupler", [], 1)
        done.code, done.ended = 0, 1.0
        self.assertIsNone(first_failure([done]))

    def test_a_free_endpoint_is_local(self):
        self.assertEqual(launch.free_endpoint("ipc", "/tmp/x"), "ipc:///tmp/x/coupler.sock")
        self.assertRegex(launch.free_endpoint("tcp", "/tmp/x"), r"^tcp://127\.0\.0\.1:\d+$")


class CommandLineTest(unittest.TestCase):
    """The tool as the user calls it."""

    TOP = pathlib.Path(__file__).resolve().parents[2]

    def call(self, *arguments, build="/nonexistent-build"):
        return subprocess.run([str(self.TOP / "scripts" / "undertow"), *arguments], capture_output=True, text=True,
                              check=False, env={**os.environ, "UNDERTOW_BUILD": build})

    def test_without_a_build_it_says_what_to_do(self):
        done = self.call("run", "cases/dam_break")
        self.assertEqual(done.returncode, 2)
        self.assertIn("run scripts/setup.sh first", done.stderr)

    def test_unknown_results_are_named(self):
        done = self.call("compare", "no_such_case")
        self.assertEqual(done.returncode, 2)
        self.assertIn("no_such_case: no results found", done.stderr)

    def test_results_that_cannot_be_written_are_said_so_before_the_run(self):
        case = str(self.TOP / "tests/faults/water_on_plate.toml")
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "file"
            file.write_text("mine")
            for out, words in ((file, "this is a file; name a folder"),
                               (file / "below", "no results can be written there (Not a directory)"),
                               ("/proc/undertow", "no results can be written there")):
                done = self.call("run", case, "--out", str(out), build=os.environ.get("UNDERTOW_BUILD", str(self.TOP / "build")))
                self.assertEqual(done.returncode, 2)
                self.assertIn(words, done.stderr)
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            self.assertEqual(file.read_text(), "mine")

    def test_help_names_the_commands(self):
        done = self.call("--help")
        self.assertEqual(done.returncode, 0)
        for command in ("run", "check", "compare", "status", "movie"):
            self.assertIn(command, done.stdout)


class EndsBeforeItJoins(unittest.TestCase):
    """Real coupler and real particles; in place of the structure a program that fails at once."""

    TOP = pathlib.Path(__file__).resolve().parents[2]

    def run_with(self, folder, body, interpreter="/usr/bin/python3"):
        backend = pathlib.Path(folder) / "backend.py"
        backend.write_text(f"#!{interpreter}\nimport os, sys\n" + body)
        backend.chmod(0o755)
        started = time.monotonic()
        done = subprocess.run([self.TOP / "scripts/undertow", "run", self.TOP / "tests/faults/water_on_plate.toml",
                               "--backend", backend, "--out", pathlib.Path(folder) / "out", "--quiet",
                               "--set", "coupling.join_timeout=60"],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, timeout=60)
        self.assertLess(time.monotonic() - started, 50)     # join_timeout is 60 s
        self.assertNotIn("user stopped", done.stdout)       # which the launcher's force makes the coupler say
        self.assertRegex(done.stdout, "a program of this run ended before it joined: nobody joined as (particles, )?surface")
        return done.returncode, done.stdout.splitlines()

    def test_its_code_and_its_last_words_are_those_of_the_run(self):
        with tempfile.TemporaryDirectory() as folder:
            code, lines = self.run_with(folder, "print('no license server', file=sys.stderr); sys.exit(7)")
        self.assertEqual(code, 7)
        self.assertIn("fem_solver failed with exit code 7", lines)
        self.assertEqual(lines[-1].strip(), "no license server")

    def test_a_crash(self):
        with tempfile.TemporaryDirectory() as folder:
            code, lines = self.run_with(folder, "os.abort()")
        self.assertEqual(code, 3)
        self.assertIn("fem_solver was ended by signal 6 (Aborted)", lines[-1])

    def test_one_that_calls_it_a_success(self):
        with tempfile.TemporaryDirectory() as folder:
            code, lines = self.run_with(folder, "")
        self.assertEqual(code, 3)
        self.assertIn("nobody joined as surface", lines[-1])

    def test_an_interpreter_that_is_not_there(self):
        with tempfile.TemporaryDirectory() as folder:
            code, lines = self.run_with(folder, "", interpreter="/nonexistent/python9")
        self.assertEqual(code, 2)
        self.assertIn("backend.py cannot be started: No such file or directory.", lines[-1])


    def test_a_full_disk_does_not_hide_why_it_failed(self):
        with tempfile.TemporaryDirectory() as folder:
            full = str(pathlib.Path(folder) / "out" / "summary.json.tmp")
            code, lines = self.run_with(folder, f"os.symlink('/dev/full', {full!r})\n"
                                                "print('no license server', file=sys.stderr); sys.exit(7)")
        self.assertEqual(code, 7)
        self.assertEqual(lines[-1].strip(), "no license server")
        self.assertFalse([line for line in lines if "Traceback" in line], lines)


class ResultsFolderTest(unittest.TestCase):
    def test_a_full_disk_is_told_with_the_name_of_the_file(self):
        from undertow_tool.results_folder import write_json

        with tempfile.TemporaryDirectory() as top:
            path = pathlib.Path(top) / "summary.json"
            path.with_suffix(".json.tmp").symlink_to("/dev/full")
            with self.assertRaises(OSError) as caught:
                write_json(path, {"t": 1})
            self.assertEqual((caught.exception.filename, caught.exception.errno), (str(path), 28))

    def test_earlier_results_move_aside_and_nothing_else_is_touched(self):
        from undertow_tool.errors import UserError
        from undertow_tool.results_folder import prepare

        with tempfile.TemporaryDirectory() as top:
            out = pathlib.Path(top) / "case"
            self.assertIsNone(prepare(out, replace=False))
            (out / "run.json").write_text(json.dumps({"number": 1}))
            self.assertIn("case.1", prepare(out, replace=False))
            self.assertEqual(json.loads((out.with_name("case.1") / "run.json").read_text()), {"number": 1})
            (out / "run.json").write_text(json.dumps({"number": 2}))
            self.assertIn("case.2", prepare(out, replace=False))
            (out / "run.json").write_text(json.dumps({"number": 3}))
            self.assertIn("replaced", prepare(out, replace=True))
            self.assertFalse(out.with_name("case.3").exists())
            (out / "thesis.tex").write_text("years of work")
            with self.assertRaises(UserError):
                prepare(out, replace=True)
            self.assertTrue((out / "thesis.tex").exists())


class DescribeRun(unittest.TestCase):
    def test_a_machine_without_git_runs_all_the_same(self):
        from unittest import mock
        from undertow_tool import results_folder
        with mock.patch.object(results_folder.shutil, "which", return_value=None), \
             mock.patch.object(results_folder.subprocess, "run", side_effect=FileNotFoundError("git")):
            self.assertIsNone(results_folder.describe_run(["undertow"], 2)["commit"])


class ThreadsTest(unittest.TestCase):
    CASE = {"case": {"dimension": 3}, "sph": {"spacing": 0.1, "fill": [{"box": {"min": [0, 0, 0], "max": [1, 1, 1]}}]}}

    def test_few_particles_get_one_thread(self):
        from unittest import mock
        from undertow_tool import threads
        with mock.patch.object(threads, "cores", return_value=4):
            self.assertEqual(threads.sensible_threads(self.CASE, spin=True), 2)       # 1,000 particles
            self.assertEqual(threads.sensible_threads(self.CASE, spin=False), 1)
            fine = {**self.CASE, "sph": {**self.CASE["sph"], "spacing": 0.02}}
            self.assertEqual(threads.sensible_threads(fine, spin=False), 4)
            self.assertEqual(threads.sensible_threads({"sph": None}, spin=False), 4)

    def test_threads_look_before_they_sleep_only_where_cores_are_free(self):
        from unittest import mock
        from undertow_tool import threads
        with mock.patch.object(threads, "cores", return_value=2):
            for busy, wanted, may in ((0, 2, True), (1, 2, False), (None, 2, False), (0, 1, False), (0, 3, False)):
                with mock.patch.object(threads, "busy_threads", return_value=busy):
                    self.assertEqual(threads.may_spin(wanted), may, (busy, wanted))
        self.assertEqual(launch.environment(2, spin=False)["GOMP_SPINCOUNT"], "0")
        self.assertEqual(launch.environment(2, spin=True)["GOMP_SPINCOUNT"], str(threads.SPIN))


if __name__ == "__main__":
    unittest.main()
