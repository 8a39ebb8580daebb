"""Runs one verification at one level and measures what it cost."""
import os
import subprocess
import time
from dataclasses import dataclass, field
from pathlib import Path

from ..case import resolve
from ..errors import INTERRUPTED, RunFailed, UserError
from ..join import join_energy, join_summaries
from ..launch import Child, environment, how_it_ended, last_words
from ..paths import TOP, program, shown
from ..report import run_report
from ..results_folder import describe_run, prepare, read_json, write_json
from ..threads import may_spin
from .measured import Measured
from .structure import MeasuredStructure, figures_of_structure

CASES = TOP / "cases" / "verify_sph"
CASES_OF_STRUCTURES = TOP / "cases" / "verify_fem"


@dataclass
class Rung:
    """One run of a ladder."""
    level: str
    variant: str = ""
    figures: dict = field(default_factory=dict)

    @property
    def label(self):
        return " ".join(part for part in (self.level, self.variant) if part)


def known_verifications():
    """Name -> folder, in alphabetical order."""
    folders = [folder for cases in (CASES, CASES_OF_STRUCTURES) for folder in sorted(cases.iterdir())]
    return {folder.name: folder for folder in folders if (folder / "case.toml").exists()}


def folder_of(target):
    """The folder of a verification: its name under cases/verify_sph or cases/verify_fem, or a path."""
    known = known_verifications()
    if target in known:
        return known[target]
    if (Path(target) / "case.toml").exists():
        return Path(target)
    raise UserError(f"{target} is no verification: known are {', '.join(known)}; or give a folder that holds case.toml.")


def named(target):
    """Targets that a name stands for: itself, or all verifications of that family, channel for channel_newton, ..."""
    known = known_verifications()
    family = [name for name in known if name.startswith(target + "_")]
    return [target] if target in known or not family else family


def ladder_of(folder, quick, long):
    """Rungs to run: the resolutions of [report] ladder, then one modeling choice at a time."""
    settings = resolve(folder, [])["report"]
    if not isinstance(settings.get("ladder"), list) or not settings["ladder"]:
        raise UserError(f"{shown(folder)}/case.toml: [report] has no ladder: list the levels to run, coarsest first.")
    if not (Path(folder) / "report.py").exists():
        raise UserError(f"{shown(folder)} has no report.py: it compares the results with what is exact; "
                        f"copy that of {shown(CASES / 'standing_wave')}.")
    levels = settings["ladder"]
    for table, values in (("gates", settings.get("gates") or {}),
                          ("defects", {name: d.get("at_most") for name, d in (settings.get("defects") or {}).items()})):
        for name, value in values.items():
            if isinstance(value, list) and len(value) != len(levels):
                raise UserError(f"{shown(folder)}/case.toml: report.{table}.\"{name}\" has {len(value)} errors for "
                                f"{len(levels)} levels of the ladder: give one for each, or one number for all.")
    for name, defect in (settings.get("defects") or {}).items():
        if "why" not in defect or name not in (settings.get("gates") or {}):
            raise UserError(f"{shown(folder)}/case.toml: report.defects.\"{name}\" needs a reason, `why`, and a gate of "
                            "its name in [report.gates].")
    if quick:
        return [Rung(level) for level in levels[:-1] or levels]
    rungs = [Rung(level) for level in levels]
    middle = levels[min(1, len(levels) - 1)]
    rungs += [Rung(middle, variant) for variant in settings.get("choices", [])]
    if long:
        rungs += [Rung(level) for level in settings.get("long", [])]
    return rungs


def run_rung(folder, rung, overrides, variants, threads, root, reuse):
    """Fills rung.figures; returns the result folder. A run that ends early is a row that fails."""
    options = ["--level", rung.level]
    for variant in [v for v in (rung.variant, *variants) if v]:
        options += ["--with", variant]
    for assignment in overrides:
        options += ["--set", assignment]
    case = resolve(folder, options)
    if case["coupled"] or bool(case["fem"]) == bool(case["sph"]):
        raise UserError(f"{case['file']}: a verification here is of one solver alone; keep one of [sph] and [fem], and take "
                        "[coupling] out.")
    out = Path(root) / "-".join([folder.name, rung.level, *([rung.variant] if rung.variant else [])])
    if reuse:
        if read_json(out / "summary.json") is None:
            raise UserError(f"{shown(out)} has no finished run to reuse; leave out --reuse.")
        cost = read_json(out / "summary.json")["cost"]
    else:
        prepare(out, replace=True)
        write_json(out / "run.json", describe_run(["verify", folder.name, *options], threads))
        cost = run_alone(f"{solver_of(case)}_solver", case, options, out, threads)
    write_json(out / "case.json", case)
    summary = {"case": case["case"]["name"], "title": case["case"]["title"], "level": rung.level,
               "variants": [v for v in (rung.variant, *variants) if v], "set": overrides, "ok": True, "exit_code": 0,
               "wall_s": cost["wall_s"], "threads": threads, "cost": cost, **join_summaries(out), "checks": []}
    join_energy(out)
    write_json(out / "summary.json", summary)
    run_report(out, case, summary)
    summary["ok"] = all(row["ok"] is not False or (row.get("defect") and not row["worse"]) for row in summary["checks"])
    write_json(out / "summary.json", summary)
    rung.figures = (figures_of if case["sph"] else figures_of_structure)(out, case, summary)
    return out


def solver_of(case):
    """ "sph" or "fem"."""
    return "sph" if case["sph"] else "fem"


def measured_of(out, case, summary):
    """What a report or a picture works with."""
    return (Measured if case["sph"] else MeasuredStructure)(out, case, summary)


def run_alone(solver, case, options, out, threads):
    """Runs the solver --alone. Wall and CPU time [s] and memory [MiB] of that one process."""
    command = [str(program(solver)), case["file"], "--out", str(out), *options, "--alone", "--quiet",
               "--threads", str(threads)]
    child = Child(solver, command, threads)
    with open(out / f"{solver}.stderr", "wb") as errors:
        started = time.monotonic()
        child.process = subprocess.Popen(command, env=environment(threads, may_spin(threads)), stdin=subprocess.DEVNULL,
                                         stdout=errors, stderr=errors)
        _, status, used = os.wait4(child.process.pid, 0)
        wall = time.monotonic() - started
    child.code = child.process.returncode = os.waitstatus_to_exitcode(status)
    if child.code == INTERRUPTED:
        raise KeyboardInterrupt
    if child.code != 0:
        raise RunFailed(child.code if child.code > 0 else 1, f"{solver} {how_it_ended(child)}"
                        + "".join(f"\n    {line}" for _, lines in last_words(child, out) for line in lines))
    return {"wall_s": round(wall, 3), "cpu_s": round(used.ru_utime + used.ru_stime, 3),
            "memory_mib": round(used.ru_maxrss / 1024, 1)}


def figures_of(out, case, summary):
    """What the table and the pictures need of one run."""
    sph, cost = summary["sph"], summary["cost"]
    measured = Measured(out, case, summary)
    return {"spacing": case["sph"]["spacing"], "particles": sph["particles"], "steps": summary["steps"],
            "dt_mean": summary["dt_mean"], **cost,
            "particle_steps_per_cpu_s": sph["particle_steps"] / max(cost["cpu_s"], 1e-9),
            "neighbors_mean": sph.get("neighbors_mean"), "max_mach": sph.get("max_mach"),
            "max_density_deviation": sph.get("max_density_deviation"),
            "momentum_error": measured.momentum_error(), "removed": sph.get("removed"),
            "put_back_behind_walls": sph.get("put_back_behind_walls"), "checks": summary["checks"]}
