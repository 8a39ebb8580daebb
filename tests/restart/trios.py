"""Runs of the three programs by scripts/undertow, for tests that cut and resume them."""
import json
import os
import pathlib
import subprocess
import time

from scenes import ENVIRONMENT, TOP, Restart

PROGRAMS = {"sph": "sph_solver", "fem": "fem_solver", "coupler": "coupler"}


class Trios(Restart):
    program = "coupler"

    def not_yet(self, *options, case="trio.toml"):
        """A folder for a run with these options, which has not begun."""
        run = self.new(case, *options)
        run.go_on = lambda *more, code=0: self.tool("resume", run.out, *more, code=code)
        return run

    def trio(self, *options, case="trio.toml", code=0):
        """A run with these options."""
        run = self.not_yet(*options, case=case)
        run.told = self.tool("run", run.case, "--out", run.out, "--threads", 1, *options, code=code)
        return run

    def check_trio(self, *options, every=0.0073):
        whole = self.trio(*options)
        cut = self.trio(*options, "--set", f"checkpoint.every={every}", "--set", "checkpoint.keep=100")
        with self.subTest("checkpoints change nothing"):
            whole.must_equal(cut)
        sets = cut.sets()
        self.assertGreater(len(sets), 5)
        for k, threads in ((0, 1), (len(sets) // 2, 2), (len(sets) - 1, 1)):
            cut.go_on("--from", sets[k].name, "--threads", threads)
            with self.subTest(resumed=sets[k].name, threads=threads):
                whole.must_equal(cut)
        return whole, cut

    # ------------------------------------------------------------ programs of a run that goes on

    def start(self, run, *options, environment=()):
        """Starts a run and returns the tool's process."""
        tool = subprocess.Popen(
            self.tool_command("run", run.case, "--out", run.out, "--threads", 1, *run.options, *options),
            env={**ENVIRONMENT, **dict(environment)}, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, text=True)
        self.addCleanup(lambda: (tool.kill(), tool.wait()) if tool.poll() is None else None)
        return tool

    def process_of(self, tool, who):
        """The id of a program that the tool has started."""
        children = pathlib.Path(f"/proc/{tool.pid}/task/{tool.pid}/children")
        for pid in children.read_text().split():
            if pathlib.Path(f"/proc/{pid}/comm").read_text().strip() == PROGRAMS[who]:
                return int(pid)
        raise AssertionError(f"there is no {PROGRAMS[who]}")

    def signal(self, tool, who, number):
        os.kill(self.process_of(tool, who), number)

    def wait(self, holds, what, seconds=120):
        end = time.monotonic() + seconds
        while not holds():
            self.assertLess(time.monotonic(), end, f"{what} did not come within {seconds} s")
            time.sleep(0.002)

    def said_by(self, *arguments):
        """What scripts/undertow says."""
        return subprocess.run(["/usr/bin/python3", str(TOP / "scripts" / "undertow"),
                               *map(str, arguments)], env=ENVIRONMENT, text=True, check=True,
                              stdout=subprocess.PIPE).stdout

    def status_line(self, run):
        return self.said_by("status", run.out)

    def status(self, run):
        try:
            return json.loads((run.out / "status.json").read_text())
        except (OSError, ValueError):
            return {}
