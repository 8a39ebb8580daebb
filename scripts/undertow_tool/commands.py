"""The commands of scripts/undertow."""
import argparse
import os
import sys
import time
import traceback
from pathlib import Path

from . import case as cases
from .errors import CHECKS_FAILED, DONE, INPUT, INTERRUPTED, RunFailed, UserError
from .pareto.command import add_command as add_pareto
from .paths import RESULTS, newest_results, shown
from .threads import cores, may_spin, sensible_threads
from . import keys, replay
from .conform import command as conform
from .verify.command import add_command as add_verify


def say(text):
    print(text, flush=True)


def run(arguments):
    from .launch import split_threads
    from .results_folder import describe_run, prepare, write_json

    options = cases.layer_options(arguments)
    case = cases.resolve(arguments.case, options)
    if case["coupled"] and not case["fem"] and not arguments.fem:
        raise UserError(f"{case['file']}: [coupling] is there but [fem] is not: name the program that "
                        "stands in for it with --fem.")
    if arguments.fem and not Path(arguments.fem).exists():
        raise UserError(f"--fem {arguments.fem}: there is no such program.")
    if arguments.fem and not arguments.fem.endswith(".py") and not os.access(arguments.fem, os.X_OK):
        raise UserError(f"--fem {arguments.fem}: this is no program that can be started; chmod +x it, or name a .py file.")
    if arguments.fem and not case["coupled"] and not case["fem"]:
        raise UserError(f"--fem {arguments.fem}: the case has no [fem] in this variant, so there is nothing to stand in for.")
    spin = may_spin(cores())
    threads = arguments.threads or sensible_threads(case, spin)
    out = (Path(arguments.out) if arguments.out else RESULTS / cases.result_name(case, arguments)).absolute()
    told = prepare(out, arguments.force)
    write_json(out / "run.json", {**describe_run(sys.argv, threads), "folder": os.getcwd(),
                                  "case": str(Path(case["file"]).resolve())})
    write_json(out / "case.json", case)

    if not arguments.quiet:
        if told:
            say(told)
        parts = [text for present, text in ((case["sph"], "SPH"), (case["fem"] or arguments.fem, "FEM")) if present]
        say(f"{case['case']['title']}: {' and '.join(parts)}{', coupled' if case['coupled'] else ''}; "
            f"results in {shown(out)}")
        if case["coupled"]:
            share = split_threads(threads, ["coupler", "sph_solver", "fem_solver"])
            say(f"threads: sph_solver {share['sph_solver']}, fem_solver {share['fem_solver']}, coupler 1 "
                f"({'cores are free: they spin up to 0.1 ms' if spin and threads > 1 else 'they sleep while they wait'})")
    return carry_out(case, out, arguments, threads, arguments.quiet, spin=spin and threads > 1)


def resume(arguments):
    from .resume import Notes, take_up

    out = results_of(arguments.target)
    notes = Notes(out)
    began, case, folder, threads = take_up(out, arguments, parser())
    if not arguments.quiet:
        say(f"{case['case']['title']}: goes on from {folder.name} in {shown(out)}")
    try:
        return carry_out(case, out, began, threads, arguments.quiet, resume=folder)
    except RunFailed as failure:
        if failure.code == INPUT:
            notes.put_back()
        raise


def carry_out(case, out, arguments, threads, quiet, resume=None, spin=None):
    """Runs the programs, from a set of checkpoints if `resume` names one, and reports."""
    from .join import join_energy, join_summaries
    from .launch import how_it_ended, last_words, run_programs
    from .report import run_report
    from .results_folder import write_json
    from .table import print_report

    options = cases.layer_options(arguments) + (["--resume", str(resume)] if resume else [])
    wire = ["--keys", str(Path(arguments.keys).absolute())] if arguments.keys else []
    # a recording is that of the run's first part, from its start: a resumed run adds nothing
    outcome = run_programs(case, options, out, threads, arguments.fem, quiet, wire,
                           ["--record"] if arguments.record and not resume else [],
                           "commands.resumed.txt" if resume else "commands.txt", spin=spin)
    summary = {"case": case["case"]["name"], "title": case["case"]["title"], "level": arguments.level,
               "variants": arguments.variants, "set": arguments.set, "ok": outcome.code == DONE,
               "exit_code": outcome.code, "wall_s": round(outcome.wall_s, 3), "cpu_s": round(outcome.cpu_s, 3), "threads": threads,
               **join_summaries(out)}
    if outcome.failed:
        try:
            write_json(out / "summary.json", summary)
        except OSError:     # the disk may be what the run failed of: its own words come first
            pass
        words = "".join(f"\n  the end of {shown(path)}:" + "".join(f"\n    {line}" for line in lines)
                        for path, lines in last_words(outcome.failed, out))
        raise RunFailed(outcome.code, f"{outcome.failed.name} {how_it_ended(outcome.failed)}{words or ' and left no log.'}")
    join_energy(out)
    if outcome.code == INTERRUPTED:
        write_json(out / "summary.json", summary)
        say(f"interrupted; what was computed is in {shown(out)}")
        if any(out.glob("checkpoints/*/manifest.json")):
            say(f"to go on: scripts/undertow resume {shown(out)}")
        elif case["checkpoint"] is None:
            say("nothing was kept to go on from; a run that shall be resumed needs a [checkpoint] table, or "
                "--set checkpoint.on_interrupt=true")
        return INTERRUPTED
    summary["checks"] = []
    write_json(out / "summary.json", summary)       # a report that fails must not cost the run
    report_failed = False
    try:
        run_report(out, case, summary)
        summary["ok"] = summary["ok"] and all(row["ok"] is not False for row in summary["checks"])
        write_json(out / "summary.json", summary)
    except Exception:      # noqa: BLE001: whatever a case's own script raises
        traceback.print_exc()
        report_failed = True
        say(f"the report of {case['case']['name']} failed (above); the results in {shown(out)} are complete")
    print_report(out, summary)
    say_warnings(outcome.children, out, summary)
    return CHECKS_FAILED if report_failed else DONE


def say_warnings(children, out, summary, most=5):
    """Once more at the end: while the run goes on those of the solvers reach their logs only."""
    from .launch import warnings_of

    told = [(child.name, text) for child in children for text in warnings_of(child, out)]
    if (summary.get("coupling") or {}).get("contacts_max") == 0:
        told.append(("the run", "no particle ever touched the coupled surface. If some should have: its facets' outward normals must "
                                "point into the fluid (set of [[fem.surface]]), and it must stand where the fluid comes to"))
    for name, text in told[:most]:
        say(f"  warning of {name}: {text}")
    if len(told) > most:
        say(f"  and {len(told) - most} warnings more in the logs")


def check(arguments):
    from .estimate import estimate

    case = cases.resolve(arguments.case, cases.layer_options(arguments))
    threads = arguments.threads or sensible_threads(case, spin=True)
    figures = estimate(case, threads)
    say(f"{case['file']}: valid. {case['case']['title']}")
    counts = [f"{figures[k]:,} {k}" for k in ("particles", "elements") if figures[k]]
    say(f"  {', '.join(counts) or 'size unknown'}; about {figures['memory'] / 2**20:.0f} MiB of memory, "
        f"{figures['disk'] / 2**20:.0f} MiB of field output")
    for dt, why in figures["dts"]:
        say(f"  dt of {why}: {dt:.3g} s")
    say(f"  dt = {figures['dt']:.3g} s, limited by {figures['limiter'].split(',')[0]}; "
        f"about {figures['steps']:,.0f} steps to t = {case['time']['end']:g} s")
    say(f"  estimated wall time {figures['wall_s']:.0f} s on {threads} thread{'s' if threads > 1 else ''}")
    for note in figures["notes"]:
        say(f"  {note}")
    if case["known_levels"] or case["known_variants"]:
        say(f"  levels: {', '.join(case['known_levels']) or 'none'}; "
            f"variants: {', '.join(case['known_variants']) or 'none'}")
    return DONE


def results_of(target):
    """A result folder: given as such, by its name under results/, or by a case's folder."""
    path = Path(target)
    candidates = [path, RESULTS / target, RESULTS / path.name]
    for folder in candidates:
        if (folder / "run.json").exists():
            return folder.absolute()
    raise UserError(f"{target}: no results found (looked in {', '.join(shown(c) for c in candidates)}); "
                    "run the case first.")


def compare(arguments):
    from .report import refresh
    from .table import comparison_table, console, print_report

    folders = [results_of(target) for target in arguments.targets]
    summaries = []
    for folder in folders:
        summary = refresh(folder)
        if summary is None:
            raise UserError(f"{shown(folder)} has no summary.json: the run did not end in good order.")
        summaries.append((folder.name, summary))
    if len(summaries) == 1:
        print_report(folders[0], summaries[0][1])
    else:
        console().print(comparison_table(summaries))
    good = all(row["ok"] is not False for _, summary in summaries for row in summary.get("checks", []))
    return DONE if good else CHECKS_FAILED


def status(arguments):
    from .results_folder import read_json

    folder = results_of(arguments.target) if arguments.target else newest_results()
    if folder is None:
        raise UserError("there are no results yet.")
    while True:
        figures = read_json(folder / "status.json")
        if figures is None:
            say(f"{shown(folder)}: no status yet")
        else:
            state = figures.get("state", "?")
            if state == "running" and not process_lives(figures.get("pid")):
                state = "ended without saying so"
            share = 100 * figures["t"] / figures["t_end"] if figures.get("t_end") else 0
            eta = figures.get("eta_s")
            say(f"{shown(folder)}: {state}, {share:.0f} %, t = {figures['t']:.4g} of {figures['t_end']:.4g} s, "
                f"step {figures['step']:,}, dt {figures['dt']:.2e} s ({figures['limiter']})"
                + (f", ETA {eta:.0f} s" if state == "running" and eta is not None else "")
                + (f", {figures['doing']}" if state == "running" and figures.get("doing") else "")
                + last_checkpoint(figures.get("checkpoint")))
        if not arguments.watch or figures is None or state != "running":
            return DONE
        time.sleep(1)


def last_checkpoint(kept):
    """Time, age and folder of the set that a resume would go on from."""
    if not kept:
        return ""
    age = max(0, time.time() - kept["written_at"])
    words = f"{age:.0f} s" if age < 100 else f"{age / 60:.0f} min" if age < 6000 else f"{age / 3600:.1f} h"
    return f"; last checkpoint at t = {kept['t']:.4g} s, {words} ago ({kept['folder']})"


def process_lives(pid):
    return pid is not None and Path(f"/proc/{pid}").exists()


def movie(arguments):
    from .movie import make_movie
    from .results_folder import read_json

    out = results_of(arguments.target)
    case = read_json(out / "case.json")
    path = Path(arguments.file).absolute() if arguments.file else out / "movie.mp4"
    frames = make_movie(out, case, path, fps=arguments.fps, height=arguments.height)
    say(f"{frames} frames: {shown(path)}")
    return DONE


def parser():
    top = argparse.ArgumentParser(prog="undertow", description="Runs, checks and compares cases of coupled SPH and FEM.")
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND")

    layered = argparse.ArgumentParser(add_help=False)
    layered.add_argument("case", metavar="CASE", help="a folder that holds case.toml, or a .toml file")
    layered.add_argument("--level", default="", help="level of detail: a [level.NAME] of the case")
    layered.add_argument("--with", dest="variants", action="append", default=[], metavar="VARIANT",
                         help="a [variant.NAME] of the case; may be repeated")
    layered.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
                         help="overrides a key, such as sph.spacing=0.005; may be repeated")
    layered.add_argument("--threads", type=positive, help="threads in all (default: every core that has enough particles to work on)")

    sub = commands.add_parser("run", parents=[layered], help="run a case and report")
    sub.add_argument("--out", metavar="DIR", help="where the results go (default: results/NAME)")
    sub.add_argument("--quiet", action="store_true", help="no live line")
    sub.add_argument("--fem", "--backend", metavar="PROGRAM", help="a program that stands in for fem_solver")
    sub.add_argument("--record", action="store_true", help="keep what the programs say, for `undertow replay`")
    sub.add_argument("--keys", metavar="FOLDER", help="encrypt, with keys of `undertow keys` (coupling.transport = \"tcp\")")
    sub.add_argument("--force", action="store_true", help="replace earlier results instead of moving them aside")
    sub.set_defaults(do=run)

    sub = commands.add_parser("resume", help="go on with a run from its last checkpoint")
    sub.add_argument("target", metavar="CASE|DIR", help="a result folder, or a case whose results are meant")
    sub.add_argument("--from", dest="from_set", default="", metavar="SET",
                     help="another checkpoint than the last: its folder, its name or its step")
    sub.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
                     help="time.end, output.* and checkpoint.* may change")
    sub.add_argument("--threads", type=positive, help="threads in all (default: as before)")
    sub.add_argument("--quiet", action="store_true", help="no live line")
    sub.set_defaults(do=resume)

    sub = commands.add_parser("check", parents=[layered], help="check a case and estimate its cost without running it")
    sub.set_defaults(do=check)

    sub = commands.add_parser("compare", help="the table of finished runs; exit code 1 if a check fails")
    sub.add_argument("targets", nargs="+", metavar="CASE|DIR", help="result folders, or cases whose results are wanted")
    sub.set_defaults(do=compare)

    sub = commands.add_parser("status", help="where a run stands")
    sub.add_argument("target", nargs="?", metavar="CASE|DIR", help="default: the newest results")
    sub.add_argument("--watch", action="store_true", help="a line every second until the run ends")
    sub.set_defaults(do=status)

    sub = commands.add_parser("movie", help="an mp4 from the field output")
    sub.add_argument("target", metavar="CASE|DIR")
    sub.add_argument("--file", metavar="MP4", help="default: movie.mp4 among the results")
    sub.add_argument("--fps", type=positive, default=25)
    sub.add_argument("--height", type=positive, default=720, help="pixels")
    sub.set_defaults(do=movie)

    add_verify(commands, positive)
    for module in (conform, keys, replay):
        module.add_command(commands)
    add_pareto(commands, positive)
    return top


def positive(text):
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text} must be >= 1")
    return value


def main(arguments):
    try:
        own, participant = conform.split(arguments)
        chosen = parser().parse_args(own)
        chosen.participant = participant
        return chosen.do(chosen)
    except UserError as error:
        print(error, file=sys.stderr)
        return INPUT
    except RunFailed as error:
        print(error, file=sys.stderr)
        return error.code
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:         # the reader of a pipe has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except OSError as error:        # a disk that is full, a folder that may not be written
        if error.filename is None:
            raise
        print(f"{error.filename}: {error.strerror}; check that it can be written and that the disk is not full.",
              file=sys.stderr)
        return INPUT
