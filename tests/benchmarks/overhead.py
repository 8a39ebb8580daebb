#!/usr/bin/python3
"""What coupling costs: the dam break's water against its wall, run by the three programs and recorded, then
the slower solver alone on the recording. Prints {"coupling.overhead_fraction": ...} as JSON; the fraction is
(run - replay) / run in wall time, the median of three: only as good as the machine is quiet. On a busy one
coupling.cpu_overhead_fraction says more: the CPU of the run that neither solver needs alone.
"""
import json
import pathlib
import statistics
import subprocess
import tempfile

TOP = pathlib.Path(__file__).resolve().parents[2]
TOOL = TOP / "scripts" / "undertow"
# Water at rest beside the wall: contact from the first step, without the second of waiting for the wave.
CASE = ["cases/dam_break", "--level", "quick", "--set", "time.end=0.02", "--set", "sph.body=false", "--set",
        'sph.fill=[{fluid = "water", box = {min = [1.01, 0, 0], max = [1.61, 0.15, 0.3]}}]']


def measure(folder, repeat):
    out = pathlib.Path(folder) / str(repeat)
    subprocess.run([TOOL, "run", *CASE, "--record", "--quiet", "--out", out], cwd=TOP, check=True,
                   stdout=subprocess.DEVNULL)
    alone = [json.loads(subprocess.run([TOOL, "replay", out, who, "--json"], cwd=TOP, check=True,
                                       capture_output=True, text=True).stdout) for who in ("sph", "fem")]
    slower = max(alone, key=lambda figures: figures["wall_s"])
    cpu = slower["run_cpu_s"]
    return {**slower, "cpu_overhead_fraction": 1 - sum(figures["cpu_s"] for figures in alone) / cpu}


def main():
    with tempfile.TemporaryDirectory(prefix="undertow-") as folder:
        runs = [measure(folder, repeat) for repeat in range(3)]
    figures = {"overhead_fraction": statistics.median(run["overhead_fraction"] for run in runs),
               "cpu_overhead_fraction": statistics.median(run["cpu_overhead_fraction"] for run in runs),
               "replay_wall_s": min(run["wall_s"] for run in runs), "run_wall_s": min(run["run_wall_s"] for run in runs),
               "steps": runs[0]["steps"]}
    print(json.dumps({f"coupling.{name}": value for name, value in figures.items()}, indent=2))


if __name__ == "__main__":
    main()
