"""Starts the programs of a run, watches them, ends them together."""
import ctypes
import os
import resource
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

from .errors import INPUT, INTERRUPTED, PEER
from .paths import program
from .threads import SPIN, may_spin

POLL = 0.05            # [s] between looks at the children
GRACE = 15             # [s] the others get to end by themselves when one fails
GRACE_ALONE = 1        # [s] a solver gets when coupler and other solver have ended and one of them failed
GRACE_TERMINATE = 5    # [s] between SIGTERM and SIGKILL


@dataclass
class Child:
    name: str                       # "sph_solver"; also its log, NAME.log
    command: list
    threads: int
    screen: bool = False            # its stderr goes to the screen (the live line)
    process: subprocess.Popen = None
    code: int = None
    ended: float = None             # [s] monotonic
    pressed: bool = False           # a signal told it to end, because another one had failed


@dataclass
class Outcome:
    code: int                       # exit code to pass through
    wall_s: float
    failed: Child = None            # whose failure came first
    children: list = field(default_factory=list)
    cpu_s: float = 0.0              # of all programs together


def split_threads(total, names):
    """The particle solver does nearly all the work and gets every core; the others wait for it most
    of the time and get one thread each. A solver that is alone gets all."""
    main = "sph_solver" if "sph_solver" in names else names[-1]
    return {name: (total if name == main else 1) for name in names}


def environment(threads, spin):
    """Of a program with so many threads, which spin a little while they wait, or sleep: see threads.py."""
    env = {k: v for k, v in os.environ.items() if k not in ("OMP_PROC_BIND", "OMP_PLACES", "GOMP_CPU_AFFINITY")}
    env.update(OMP_NUM_THREADS=str(threads), OMP_WAIT_POLICY="passive", GOMP_SPINCOUNT=str(SPIN if spin else 0),
               UNDERTOW_CASE_TOOL=str(program("undertow_case")))
    return env


def backend_command(backend):
    """A stand-in for fem_solver: an executable, or a Python script."""
    path = Path(backend).resolve()
    if path.suffix == ".py" and not os.access(path, os.X_OK):
        return ["/usr/bin/python3", str(path)]
    return [str(path)]


def free_endpoint(transport, folder):
    if transport == "tcp":
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            return f"tcp://127.0.0.1:{probe.getsockname()[1]}"
    return f"ipc://{folder}/coupler.sock"


def plan(case, layer_options, out, threads, backend, quiet, endpoint, wire=(), of_coupler=()):
    """The programs of a run, the coupler first: a list of Child. wire: options of all in a coupled run."""
    common = [case["file"], "--out", str(out), *layer_options]
    shown = ["--quiet"] if quiet else []
    fem = backend_command(backend) if backend else [str(program("fem_solver"))] if case["fem"] else None
    if case["coupled"]:
        share = split_threads(threads, ["coupler", "sph_solver", "fem_solver"])
        return [
            Child("coupler", [str(program("coupler")), *common, "--endpoint", endpoint, *wire, *of_coupler, *shown], 1,
                  screen=True),
            Child("sph_solver", [str(program("sph_solver")), *common, "--coupler", endpoint, *wire, "--threads",
                                 str(share["sph_solver"]), *shown], share["sph_solver"]),
            Child("fem_solver", [*fem, *common, "--coupler", endpoint, *wire, "--threads", "1", *shown], 1),
        ]
    name = "sph_solver" if case["sph"] else "fem_solver"
    command = [str(program("sph_solver"))] if case["sph"] else fem
    return [Child(name, [*command, *common, "--alone", "--threads", str(threads), *shown], threads, screen=True)]


def at_birth():
    """In the child: if the launcher is killed, the kernel asks this program to end as well. SIGUSR1 waits
    until the program has said what it means to it."""
    pr_set_pdeathsig = 1
    ctypes.CDLL(None).prctl(pr_set_pdeathsig, signal.SIGTERM)
    signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGUSR1])


class Watch:
    """Runs the children to their common end."""

    def __init__(self, children, out, spin=False):
        self.children = children
        self.out = out
        self.spin = spin              # threads that wait for each other
        self.interrupts = 0
        self.deadline = None          # [s] monotonic, when the next harder signal is due
        self.harder = [signal.SIGTERM, signal.SIGKILL]

    def run(self):
        started = time.monotonic()
        previous = {number: signal.signal(number, self._interrupted) for number in (signal.SIGINT, signal.SIGTERM)}
        try:
            for child in self.children:
                self._start(child)
            while any(child.code is None for child in self.children):
                self._reap()
                self._spread()
                self._press()
                time.sleep(POLL)
        finally:
            self._kill_all()
            for number, handler in previous.items():
                signal.signal(number, handler)
        return self._outcome(time.monotonic() - started)

    def _start(self, child):
        stderr = None if child.screen else open(self.out / f"{child.name}.stderr", "wb")
        try:
            # A session of its own: Ctrl-C reaches this launcher only, which ends the run in order.
            child.process = subprocess.Popen(child.command, env=environment(child.threads, self.spin),
                                             stdin=subprocess.DEVNULL, stderr=stderr,
                                             stdout=None if child.screen else stderr,
                                             start_new_session=True, preexec_fn=at_birth)
        except OSError as error:     # no program at all: ends the others like one that failed
            child.code, child.ended = INPUT, time.monotonic()
            told = f"{child.command[0]} cannot be started: {error.strerror}."
            (self.out / f"{child.name}.stderr").write_text(told + "\n")
        finally:
            if stderr:
                stderr.close()

    def _interrupted(self, _number, _frame):
        self.interrupts += 1
        if self.interrupts == 1:
            # The coupler (or the solver that is alone) ends the run; the others follow by FINISH.
            self._signal(self.children[0], signal.SIGINT)
        else:
            self.deadline = time.monotonic()

    @staticmethod
    def _signal(child, number):
        if child.process and child.code is None:
            try:
                os.killpg(child.process.pid, number)
            except ProcessLookupError:
                pass

    def _reap(self):
        for child in self.children:
            if child.code is None and child.process and child.process.poll() is not None:
                child.code = child.process.returncode
                child.ended = time.monotonic()
                if child.code != 0 and self.deadline is None:
                    self.deadline = child.ended + GRACE

    def _spread(self):
        """Who has joined learns of a failure by the wire. The coupler cannot see that somebody will never
        join, nor a solver that still prepares itself that nobody waits for it."""
        ended = [child for child in self.children if child.code is not None]
        left = [child for child in self.children if child.code is None and not child.pressed]
        if not ended or self.interrupts:
            return
        if left and left[0].name == "coupler":
            self._end(left[0], signal.SIGUSR1)      # which counts until all have joined
        elif (len(left) == 1 and any(child.code for child in ended)
              and time.monotonic() > max(child.ended for child in ended) + GRACE_ALONE):
            self._end(left[0], signal.SIGTERM)      # in good order: after its step and its output

    def _end(self, child, number):
        child.pressed = True
        self._signal(child, number)

    def _press(self):
        """Signals of rising strength to whoever is left when a deadline has passed."""
        if self.deadline is None or time.monotonic() < self.deadline or not self.harder:
            return
        number = self.harder.pop(0)
        for child in self.children:
            child.pressed = child.pressed or child.code is None
            self._signal(child, number)
        self.deadline = time.monotonic() + GRACE_TERMINATE

    def _kill_all(self):
        for child in self.children:
            self._signal(child, signal.SIGKILL)
        for child in self.children:
            if child.process:
                child.process.wait()

    def _outcome(self, wall_s):
        if self.interrupts:
            return Outcome(INTERRUPTED, wall_s, None, self.children)
        failed = first_failure(self.children)
        if failed is None:
            return Outcome(0, wall_s, None, self.children)
        return Outcome(failed.code if failed.code > 0 else PEER, wall_s, failed, self.children)


def first_failure(children):
    """Whose failure is the cause. Until the others are pressed to end, a program that failed by itself
    (input, physics, a crash) comes before one that only lost its peer."""
    failed = sorted((child for child in children if child.code), key=lambda child: child.ended)
    if not failed:
        return None
    told = (INTERRUPTED, -signal.SIGTERM, -signal.SIGKILL)      # obeyed, no cause
    near = [child for child in failed
            if child.ended - failed[0].ended < GRACE and not (child.pressed and child.code in told)]
    return next((child for child in near if child.code != PEER), failed[0])


def last_words(child, out, lines=10):
    """The end of a program's log, and what it printed beside: (path, lines) of each that has some."""
    words, log = [], ""
    for path in (out / f"{child.name}.log", out / f"{child.name}.stderr"):
        try:
            text = path.read_text(errors="replace").strip()
        except FileNotFoundError:
            continue
        # An error stands in the log and on the screen, there behind "program: error: ".
        own = [line for line in text.splitlines() if line.split(": ", 2)[-1] not in log]
        if own:
            words.append((path, own[-lines:]))
        log = text
    return words


def warnings_of(child, out):
    """The warnings in a program's log, each text once."""
    try:
        lines = (out / f"{child.name}.log").read_text(errors="replace").splitlines()
    except FileNotFoundError:
        return []
    return list(dict.fromkeys(line.partition(f" {child.name} warning: ")[2] for line in lines
                              if f" {child.name} warning: " in line))


def how_it_ended(child):
    if child.code < 0:
        return f"was ended by signal {-child.code} ({signal.strsignal(-child.code)})"
    return f"failed with exit code {child.code}"


def cpu_of_children():
    """[s] of all that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def run_programs(case, layer_options, out, threads, backend, quiet, wire=(), of_coupler=(), commands="commands.txt",
                 spin=None):
    """Runs a case; returns an Outcome. The socket lives in a private folder that goes with the run. spin: whether
    waiting threads do; None: if cores are free."""
    private = tempfile.mkdtemp(prefix="undertow-")       # mode 0700
    try:
        endpoint = free_endpoint((case["coupling"] or {}).get("transport", "ipc"), private)
        children = plan(case, layer_options, out, threads, backend, quiet, endpoint, wire, of_coupler)
        (out / commands).write_text("".join(shlex.join(map(str, c.command)) + "\n" for c in children))
        sys.stdout.flush()
        before = cpu_of_children()
        outcome = Watch(children, out, may_spin(threads) if spin is None else spin).run()
        outcome.cpu_s = cpu_of_children() - before
    finally:
        shutil.rmtree(private, ignore_errors=True)
    for child in children:
        silent = out / f"{child.name}.stderr"
        if silent.exists() and silent.stat().st_size == 0:
            silent.unlink()
    return outcome
