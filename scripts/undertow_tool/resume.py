"""A run goes on from one of its checkpoints."""
import os
import time
from pathlib import Path

from . import case as cases
from .errors import UserError
from .paths import shown
from .results_folder import describe_run, read_json, write_json


def newest_set(out):
    """The folder of the last whole set of checkpoints: its manifest is written last."""
    sets = sorted(path.parent for path in out.glob("checkpoints/step_*/manifest.json"))
    if not sets:
        raise UserError(f"{shown(out)} holds no checkpoint; give the case a [checkpoint] table "
                        "(every = ... [s]) and run it anew.")
    return sets[-1]


def chosen_set(out, chosen):
    """A set by its folder, by its name, or by its step."""
    step = f"step_{int(chosen):09d}" if chosen.isdigit() else chosen
    for folder in (Path(chosen), out / "checkpoints" / step):
        if (folder / "manifest.json").exists():
            return folder
    known = ", ".join(path.parent.name for path in sorted(out.glob("checkpoints/step_*/manifest.json")))
    raise UserError(f"--from {chosen}: there is no such checkpoint; {shown(out)} has {known or 'none'}.")


def refuse_if_running(out):
    figures = read_json(out / "status.json") or {}
    pid = figures.get("pid")
    if figures.get("state") == "running" and pid and Path(f"/proc/{pid}").exists():
        raise UserError(f"{shown(out)} is still running (process {pid}); end it first.")


class Notes:
    """What a results folder says of its run; put back when the programs refuse to resume."""

    def __init__(self, out):
        self.texts = {path: path.read_text() for path in (out / "run.json", out / "case.json") if path.exists()}

    def put_back(self):
        for path, text in self.texts.items():
            path.write_text(text)


def take_up(out, arguments, parser):
    """The run in `out` as it was told to start: its arguments, its case with what is set now, and
    the set to go on from. run.json and case.json keep the story."""
    told = read_json(out / "run.json") or {}
    if "case" not in told:
        raise UserError(f"{shown(out)} was written by a version that cannot resume; run the case anew.")
    began = parser.parse_args(["run", *told["command"][2:]])
    began.set += arguments.set
    folder = chosen_set(out, arguments.from_set) if arguments.from_set else newest_set(out)
    refuse_if_running(out)
    case = cases.resolve(told["case"], cases.layer_options(began))
    if began.fem:       # one that can write checkpoints: the coupler refuses the others at the start
        began.fem = str(Path(told["folder"], began.fem))
    threads = arguments.threads or told.get("threads") or os.cpu_count()
    told.setdefault("resumed", []).append(
        {**{key: value for key, value in describe_run([], threads).items() if key != "command"},
         "from": folder.name, "set": arguments.set, "time": time.strftime("%Y-%m-%d %H:%M:%S%z")})
    told["command"] += [word for assignment in arguments.set for word in ("--set", assignment)]
    write_json(out / "run.json", told)
    write_json(out / "case.json", case)
    return began, case, folder, threads
