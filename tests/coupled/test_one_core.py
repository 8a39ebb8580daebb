"""Three programs on one core (taskset -c 0): nobody spins. Who waits sleeps, so the run needs the CPU
that it needs on two cores, and three programs of which one is stopped need none."""
import os
import pathlib
import resource
import signal
import sys
import time
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "faults"))
from harness import Scene  # noqa: E402

LONG = ("--set", "coupling.join_timeout=60", "--set", "coupling.deadline=60", "--set",
        "output.fields_every=100")
TICK = os.sysconf("SC_CLK_TCK")


def on_core_0():
    os.sched_setaffinity(0, {0})


def cpu_of(program):
    """[s] user and system, of a running process."""
    fields = pathlib.Path(f"/proc/{program.process.pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICK


class OneCore(unittest.TestCase):
    def run_trio(self, before=None):
        """CPU and wall time [s] of 5500 steps."""
        def cpu():
            usage = resource.getrusage(resource.RUSAGE_CHILDREN)
            return usage.ru_utime + usage.ru_stime
        with Scene() as scene:
            used, start = cpu(), time.monotonic()
            scene.start_trio(*LONG, "--set", "time.end=3", before=before)
            for name in ("coupler", "sph", "fem"):
                self.assertEqual(scene[name].wait(250), 0, scene.report())
            return cpu() - used, time.monotonic() - start

    def test_the_run_needs_no_more_cpu_on_one_core(self):
        there, wall_there = self.run_trio(on_core_0)
        free, wall_free = self.run_trio()
        print(f"one core {there:.2f} s of CPU in {wall_there:.2f} s, all cores {free:.2f} s in "
              f"{wall_free:.2f} s", file=sys.stderr)
        # spinning would cost time slices of milliseconds at each of 5500 steps; a busy machine's
        # cold caches cost some tens of percent
        self.assertLess(there, 1.5 * free + 0.5)

    def test_who_waits_for_a_stopped_program_sleeps(self):
        with Scene() as scene:
            scene.start_trio(*LONG, before=on_core_0)
            scene.wait_for_step(500, 60)
            scene["sph"].signal(signal.SIGSTOP)
            time.sleep(0.3)     # what was under way has been done
            before = {name: cpu_of(scene[name]) for name in ("coupler", "fem")}
            time.sleep(3)
            for name, used in before.items():
                self.assertLess(cpu_of(scene[name]) - used, 0.06, f"{name} did not sleep")


if __name__ == "__main__":
    unittest.main()
