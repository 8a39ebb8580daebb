"""Scenes of real processes for the fault matrix: start them, hurt them, see what a user would read.

    with Scene() as scene:
        scene.start_trio()
        scene.wait_for_step(100)
        scene["sph"].kill()
        scene.expect("coupler", code=3, says="sph vanished", within=2)

Every scene has a folder and an endpoint of its own, so that tests run side by side. With
UNDERTOW_FAULT_RECORD=FILE each expectation that held is appended to FILE, for table.py.
"""
import json
import os
import pathlib
import re
import signal
import subprocess
import tempfile
import time
import traceback
import unittest

HERE = pathlib.Path(__file__).resolve().parent
TOP = HERE.parents[1]
BIN = pathlib.Path(os.environ.get("UNDERTOW_BUILD", TOP / "build")) / "bin"

BUSY = 60.0     # [s] what a slow or loaded machine may add to any time; who ends for another reason says so
LOGS = {"coupler": "coupler.log", "sph": "sph_solver.log", "fem": "fem_solver.log"}
ENVIRONMENT = {**os.environ, "OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive",
               "GOMP_SPINCOUNT": "0", "PYTHONDONTWRITEBYTECODE": "1"}


def record(row, text="", **entry):
    """A line for table.py, if somebody asked for it: a program's end, or a figure as `text`."""
    if os.environ.get("UNDERTOW_FAULT_RECORD"):
        test = next(frame for frame in traceback.extract_stack() if frame.name.startswith("test_"))
        entry = {"row": row, "text": text, "test": test.name,
                 "file": pathlib.Path(test.filename).stem, **entry}
        with open(os.environ["UNDERTOW_FAULT_RECORD"], "a", encoding="utf-8") as file:
            file.write(json.dumps(entry) + "\n")


class Program:
    """A process of the scene, and what it told its user."""

    def __init__(self, name, command, out, log, environment=(), before=None):
        self.name, self.log_path = name, log
        self.stderr_path = out / f"{name}.stderr"
        with open(self.stderr_path, "wb") as stderr:
            self.process = subprocess.Popen([str(part) for part in command], stderr=stderr,
                                            stdout=subprocess.DEVNULL, preexec_fn=before,
                                            env={**ENVIRONMENT, **dict(environment)})

    def signal(self, number):
        self.process.send_signal(number)

    def kill(self):
        self.signal(signal.SIGKILL)

    def wait(self, seconds):
        try:
            return self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            return None

    def said(self):
        """Log and terminal."""
        return "".join(path.read_text(errors="replace")
                       for path in (self.log_path, self.stderr_path) if path.exists())

    def sentence(self, part=""):
        """The error as the user reads it: the line that holds `part`, without time and program."""
        lines = [line for line in self.said().splitlines() if part in line]
        text = next((line for line in lines if "error" in line), lines[0] if lines else "")
        return re.sub(r"^.*?(error\S*: | ERROR )", "", text)     # ours, or a Python backend's

    def memory(self, key="VmRSS", pid=None):
        """[kB] of /proc/PID/status; VmHWM is the peak. None of a process that has ended."""
        text = pathlib.Path(f"/proc/{pid or self.process.pid}/status").read_text()
        found = re.search(key + r":\s+(\d+)", text)
        return int(found[1]) if found else None

    def only_child(self):
        """The process that a measured program runs in."""
        pid = self.process.pid
        (child,) = pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
        return int(child)

    def descriptors(self):
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))


class Scene:
    def __init__(self, case="water_on_plate", transport="ipc"):
        self.case = HERE / f"{case}.toml"
        self.folder = tempfile.TemporaryDirectory(prefix="undertow-")
        self.path = pathlib.Path(self.folder.name)
        self.out = self.path / "results"
        self.out.mkdir()
        self.endpoint = f"ipc://{self.path}/socket/coupler.sock"
        self.programs, self.since = {}, time.monotonic()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for program in self.programs.values():
            if program.process.poll() is None:
                program.signal(signal.SIGCONT)
                program.kill()
                program.process.wait()
        self.folder.cleanup()

    def __getitem__(self, name):
        return self.programs[name]

    # ------------------------------------------------------------ starting

    def start(self, name, command, log=None, **how):
        log = self.out / (log or LOGS.get(name, f"{name}.log"))
        self.programs[name] = Program(name, command, self.out, log, **how)
        return self.programs[name]

    def start_coupler(self, *options, name="coupler", out=None, measured=False, **how):
        """measured: its largest memory is known when it has ended, see peak()."""
        before = [BIN / "peak_memory", self.path / f"{name}.peak"] if measured else []
        return self.start(name, [*before, BIN / "coupler", self.case, "--out", out or self.out, "--endpoint",
                                 self.endpoint, "--quiet", *options], **how)

    def start_solver(self, name, *options, **how):
        return self.start(name, [BIN / f"{name}_solver", self.case, "--out", self.out, "--coupler",
                                 self.endpoint, "--quiet", "--threads", "1", *options], **how)

    def start_dummy(self, role, *options, name=None, **how):
        name = name or {"particles": "sph", "surface": "fem"}[role]
        return self.start(name, [BIN / "dummy_peer", role, "--endpoint", self.endpoint, "--log",
                                 self.out / f"{name}.dummy.log", *options],
                          log=f"{name}.dummy.log", **how)

    def start_trio(self, *options, **how):
        self.start_coupler(*options, **how)
        for name in ("sph", "fem"):
            self.start_solver(name, *options, **how)

    # ------------------------------------------------------------ watching

    def status(self):
        try:
            return json.loads((self.out / "status.json").read_text())
        except (OSError, ValueError):
            return {}

    def peak(self, name="coupler"):
        """[kB] the most memory that a measured program had, from its rusage; it must have ended."""
        return int((self.path / f"{name}.peak").read_text())

    def wait_for_step(self, step, seconds=120):
        """Until the coupler reports more than `step` steps (it does so once a second)."""
        self.wait_until(lambda: self.status().get("step", 0) > step, f"step {step}", seconds)

    def wait_until(self, holds, what, seconds=120):
        end = time.monotonic() + seconds
        while not holds():
            if time.monotonic() > end:
                raise AssertionError(f"{what} did not come within {seconds} s\n{self.report()}")
            time.sleep(0.01)

    def wait_for_join(self, name):
        """Until a dummy says that it has its place."""
        self.wait_until(lambda: "joined" in self[name].said(), f"{name}'s place")

    def wait_for_outputs(self, outputs):
        """Until both solvers have written so many fields."""
        def written(name):
            path = self.out / f"{name}.xdmf"
            return path.read_text().count("<Time") if path.exists() else 0
        self.wait_until(lambda: min(written("sph"), written("fem")) >= outputs, f"{outputs} outputs")

    def wait_for_coupler(self):
        """Until the coupler listens."""
        self.wait_until(lambda: "waiting for participants" in self["coupler"].said(), "the coupler")

    def now(self):
        """The moment from which the times to end count: when the fault is made."""
        self.since = time.monotonic()

    def report(self):
        return "\n".join(f"---- {name} ({program.process.poll()})\n{program.said()}"
                         for name, program in self.programs.items())

    # ------------------------------------------------------------ judging

    def expect(self, name, code, says="", within=2.0, row=None):
        """`name` ends with `code`, having said `says`, `within` seconds of now() (and what a busy
        machine adds). Returns the sentence."""
        program = self.programs[name]
        left = max(0.01, self.since + within + BUSY - time.monotonic())
        got = program.wait(left)
        took = time.monotonic() - self.since
        if got != code or says not in program.said():
            raise AssertionError(f"{name} ended with {got} after {took:.1f} s and should have ended "
                                 f"with {code} within {within} s, saying '{says}'\n{self.report()}")
        sentence = program.sentence(says) if says else ""
        if row:
            record(row, who=name, code=code, seconds=took,
                   sentence=sentence.replace(str(self.path), "DIR"))
        return sentence

    def expect_output_whole(self, least_fields=1):
        """Every file that a reader might open is whole. Returns the number of field outputs."""
        import h5py
        fields = []
        for name in ("sph", "fem"):
            with h5py.File(self.out / f"{name}.vtkhdf", "r") as file:
                steps = file["VTKHDF/Steps"].attrs["NSteps"]
                assert len(file["VTKHDF/Steps/Values"]) >= steps, f"{name}: fewer times than steps"
                # who is killed while writing leaves rows behind the last counted step, which nobody reads
                last = steps - 1
                rows = (file["VTKHDF/Steps/PointOffsets"][last]
                        + file["VTKHDF/NumberOfPoints"][file["VTKHDF/Steps/PartOffsets"][last]])
                for data in (file["VTKHDF/Points"], *file["VTKHDF/PointData"].values()):
                    assert len(data) >= rows, f"{name}: {data.name} has {len(data)} rows of {rows}"
                    assert abs(data[rows - 1]).max() < 1e12, f"{name}: {data.name}"
                assert abs(file["VTKHDF/Points"][rows - 1]).max() < 1, name
                fields.append(int(steps))
        assert min(fields) >= least_fields, f"only {fields} field outputs"
        for path in self.out.glob("*.csv"):
            check_csv(path)
        for path in self.out.glob("*.json"):
            json.loads(path.read_text())
        return fields


def check_csv(path):
    """Every row is whole: as many numbers as the header names, and a line's end."""
    text = path.read_text()
    assert text.endswith("\n"), f"{path.name} ends within a row: ...{text[-60:]!r}"
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    for line in lines[1:]:
        values = line.split(",")
        assert len(values) == len(lines[0].split(",")), f"{path.name}: torn row {line!r}"
        for value in values:
            float(value)


class Case(unittest.TestCase):
    longMessage = True
