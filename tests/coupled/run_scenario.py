#!/usr/bin/python3
"""Runs one coupled scenario with real processes and checks what came of it.

    run_scenario.py FOLDER --bin BUILD/bin

FOLDER holds case.toml and scenario.toml:

    within = 6.0              # [s] everybody must have ended by then, and a minute more on a busy machine
    [coupler]                 # and [particles], [surface]: a table each; absent = not started
    args = ["--quiet"]        # further arguments
    exit = 3                  # expected exit code; -9 = killed
    log = ["sph vanished"]    # texts that its log must contain
    interrupt_when = { steps = 100 }          # SIGINT to this process when the coupler has told so many steps,
    interrupt_when = { joined = "particles" } # when that one has its place while the coupler waits, or
    interrupt_when = { ended = "coupler" }    # when that one has ended
    kill_when = ...                           # SIGKILL, likewise
    [files]                   # after the run: files of the results that must exist
    exist = ["forces.csv"]

and, if the outcome is a number, check.py with check(results): raises AssertionError.
Exit code 0: all as expected. Otherwise the logs are printed.
"""
import argparse
import importlib.util
import json
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import tomllib

ORDER = ("coupler", "particles", "surface")
BUSY = 60.0     # [s]
LOGS = {"coupler": "coupler.log", "particles": "particles.log", "surface": "surface.log"}


def command(who, table, binaries, folder, out, endpoint):
    args = [str(arg) for arg in table.get("args", [])]
    if who == "coupler":
        return [binaries / "coupler", folder / "case.toml", "--out", out, "--endpoint", endpoint,
                "--quiet", *args]
    return [binaries / "dummy_peer", who, "--endpoint", endpoint, "--log", out / LOGS[who], *args]


def start_all(scenario, binaries, folder, out, endpoint):
    return {who: subprocess.Popen(command(who, scenario[who], binaries, folder, out, endpoint),
                                  stdout=subprocess.DEVNULL, stderr=open(out / f"{who}.stderr", "w"))
            for who in ORDER if who in scenario}


def has_come(moment, running, out):
    """Whether the moment of a signal has come: told by events, so that the machine's speed decides nothing."""
    ((event, what),) = moment.items()
    if event == "ended":
        return running[what].poll() is not None
    if event == "joined":
        return "joined" in (out / LOGS[what]).read_text() if (out / LOGS[what]).exists() else False
    try:
        return json.loads((out / "status.json").read_text())["step"] >= what
    except (OSError, ValueError, KeyError):
        return False


def wait_all(scenario, running, out, start):
    """Sends the signals that the scenario asks for and waits; returns who is still running."""
    signals = [(scenario[who][key], who, number) for who in running
               for key, number in (("interrupt_when", signal.SIGINT), ("kill_when", signal.SIGKILL))
               if key in scenario[who]]
    while any(process.poll() is None for process in running.values()):
        for entry in [entry for entry in signals if has_come(entry[0], running, out)]:
            signals.remove(entry)
            if running[entry[1]].poll() is None:
                running[entry[1]].send_signal(entry[2])
        if time.monotonic() - start > scenario["within"] + BUSY:
            break
        time.sleep(0.02)
    return [who for who, process in running.items() if process.poll() is None]


def judge(scenario, running, out):
    complaints = []
    for who, process in running.items():
        expected = scenario[who].get("exit", 0)
        if process.returncode != expected:
            complaints.append(f"{who} ended with {process.returncode}, expected {expected}")
        path = out / LOGS[who]
        text = path.read_text() if path.exists() else ""
        complaints += [f"{LOGS[who]} does not say '{wanted}'"
                       for wanted in scenario[who].get("log", []) if wanted not in text]
    complaints += [f"{name} is missing" for name in scenario.get("files", {}).get("exist", [])
                   if not (out / name).exists()]
    return complaints


def check_figures(folder, out):
    path = folder / "check.py"
    if not path.exists():
        return []
    spec = importlib.util.spec_from_file_location("check", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    try:
        module.check(out)
    except AssertionError as error:
        return [f"check.py: {error}"]
    return []


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    options = parser.parse_args()
    sys.dont_write_bytecode = True
    scenario = tomllib.loads((options.folder / "scenario.toml").read_text())
    with tempfile.TemporaryDirectory(prefix="undertow-") as scratch:
        out = pathlib.Path(scratch) / "results"
        out.mkdir()
        endpoint = f"ipc://{scratch}/socket/coupler.sock"
        start = time.monotonic()
        running = start_all(scenario, options.bin, options.folder, out, endpoint)
        try:
            late = wait_all(scenario, running, out, start)
        finally:
            for process in running.values():
                if process.poll() is None:
                    process.kill()
                    process.wait()
        took = time.monotonic() - start
        complaints = [f"{who} still ran after {scenario['within'] + BUSY} s" for who in late]
        complaints += judge(scenario, running, out)
        if not complaints:
            complaints = check_figures(options.folder, out)
        if complaints:
            for complaint in complaints:
                print("FAILED:", complaint)
            for who in running:
                path = out / LOGS[who]
                print(f"---- {LOGS[who]}", path.read_text() if path.exists() else "(none)",
                      f"---- {who}, stderr", (out / f"{who}.stderr").read_text(), sep="\n")
            return 1
        print(f"as expected, in {took:.2f} s")
        return 0


if __name__ == "__main__":
    sys.exit(main())
