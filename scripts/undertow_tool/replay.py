"""undertow replay: one solver of a recorded run again, without coupler and without the other one.

What the run took longer than the slower solver alone is the price of the coupling: contact, messages,
and waiting for each other's slow steps.
"""
import json
import shlex
import shutil
import subprocess
import time
from pathlib import Path

from .errors import DONE, RunFailed, UserError
from .launch import cpu_of_children, environment
from .paths import TOP, shown
from .results_folder import read_json

LINE = {"sph": 1, "fem": 2}         # of commands.txt; the coupler's is the first


def with_option(command, option, value):
    """The command with `option value` in place of what it had."""
    if option not in command:
        return [*command, option, value]
    at = command.index(option)
    return [*command[:at + 1], value, *command[at + 2:]]


def replay_command(folder, who, out):
    commands = (folder / "commands.txt").read_text().splitlines()
    recording = folder / f"recording.{who}.utow"
    if not recording.exists() or len(commands) < 3:
        raise UserError(f"{shown(folder)} has no recording of {who}: run the case with --record first.")
    command = shlex.split(commands[LINE[who]])
    return with_option(with_option(command, "--coupler", f"replay://{recording.absolute()}"), "--out", str(out))


def verdict_of(log):
    lines = [line for line in log.read_text(errors="replace").splitlines() if "replay: " in line] if log.exists() else []
    return lines[-1].split("replay: ", 1)[1] if lines else "this program does not compare what it says"


def slower(folder):
    """Who waited less: the run waited for that one."""
    waits = {who: (read_json(folder / f"summary.{who}.json") or {}).get("wait_s") for who in LINE}
    known = {who: wait for who, wait in waits.items() if wait is not None}
    if not known:
        raise UserError(f"{shown(folder)} does not say who waited: name sph or fem.")
    return min(known, key=known.get)


def measure(folder, who):
    """Runs it; a dict of figures."""
    out = folder / f"replay.{who}"
    out.mkdir(exist_ok=True)
    command = replay_command(folder, who, out)
    threads = int(command[command.index("--threads") + 1]) if "--threads" in command else 1
    before, start = cpu_of_children(), time.monotonic()
    place = Path.cwd() if Path(command[1]).exists() else TOP
    done = subprocess.run(command, cwd=place, env=environment(threads, spin=False), capture_output=True, text=True, check=False)
    cpu = cpu_of_children() - before
    shutil.rmtree(out / "checkpoints", ignore_errors=True)      # parts of sets, written as the run wrote them
    if done.returncode != 0:
        raise RunFailed(done.returncode, f"the replay of {who} ended with {done.returncode}: {done.stderr.strip()}")
    own, run = read_json(out / f"summary.{who}.json") or {}, read_json(folder / "summary.coupler.json") or {}
    own = own | own.get(who, {})
    wall = own.get("wall_s", time.monotonic() - start)
    figures = {"who": who, "steps": run.get("steps"), "wall_s": wall,
               "cpu_s": cpu, "run_cpu_s": (read_json(folder / "summary.json") or {}).get("cpu_s"),
               "run_wall_s": run.get("wall_s"), "verdict": verdict_of(out / Path(command[0]).with_suffix(".log").name)}
    if run.get("wall_s"):
        figures["overhead_fraction"] = 1 - wall / run["wall_s"]
    return figures


def replay(arguments):
    folder = Path(arguments.folder)
    if not (folder / "commands.txt").exists():
        raise UserError(f"{arguments.folder} is no folder of results.")
    figures = measure(folder, arguments.who or slower(folder))
    if arguments.json:
        print(json.dumps(figures, indent=2))
        return DONE
    print(f"{figures['who']}: {figures['steps']} steps in {figures['wall_s']:.2f} s, {figures['cpu_s']:.2f} s of CPU; "
          f"{figures['verdict']}")
    if "overhead_fraction" in figures:
        print(f"the run took {figures['run_wall_s']:.2f} s: overhead of the coupling "
              f"{100 * figures['overhead_fraction']:.1f} %")
    return DONE


def add_command(commands):
    sub = commands.add_parser("replay", help="one solver of a recorded run again, without the others")
    sub.add_argument("folder", metavar="DIR", help="results of `undertow run --record`")
    sub.add_argument("who", nargs="?", choices=list(LINE), help="default: the slower one")
    sub.add_argument("--json", action="store_true", help="figures as JSON")
    sub.set_defaults(do=replay)
