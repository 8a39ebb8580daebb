"""undertow pareto: runs the ladder of a case, then compares error and cost."""
import os
import shutil
import subprocess
import sys
from pathlib import Path

from ..case import resolve
from ..errors import CHECKS_FAILED, DONE, INTERRUPTED, RunFailed, UserError
from ..paths import RESULTS, TOP, shown
from ..results_folder import describe_run, read_json, write_json
from ..table import console
from .ladder import ladder_names, read_ladder
from .measure import figures_of
from .page import draw, page_text, screen_table


def say(text):
    print(text, flush=True)


def pareto(arguments):
    case = resolve(arguments.case, [])["case"]["name"]
    names = ladder_names(arguments.case)
    if not arguments.ladder and len(names) > 1:
        raise UserError(f"{arguments.case} has several ladders: name one of {', '.join(names)}.")
    ladder = read_ladder(arguments.case, arguments.ladder or (names[0] if names else ""))
    root = (Path(arguments.out) if arguments.out else RESULTS / "pareto" / f"{case}-{ladder.name}").absolute()
    root.mkdir(parents=True, exist_ok=True)
    failed = []
    for run in ladder.runs:
        if arguments.reuse and (root / run.folder / "summary.json").exists():
            continue
        say(f"{case}, {run.name} ...")
        code = run_one(arguments, run, root / run.folder)
        if code == INTERRUPTED:
            raise KeyboardInterrupt
        if code not in (DONE, CHECKS_FAILED):       # a check that fails is a result
            say(f"{case}, {run.name}: ended with code {code}; it is left out of the table.")
            failed.append(run.name)
    if ladder.reference in failed:
        raise RunFailed(CHECKS_FAILED, f"the run that the others are compared with, {ladder.reference}, failed.")
    folders = {run.name: root / run.folder for run in ladder.runs}
    figures = [figures_of(ladder, run, folders[run.name], folders[ladder.reference or run.name])
               for run in ladder.runs if run.name not in failed]
    made = describe_run(sys.argv, arguments.threads or len(os.sched_getaffinity(0)))
    write_json(root / "pareto.json", {"case": case, "ladder": ladder.name, "made": made, "runs": figures, "failed": failed})
    picture = root / f"{case}_{ladder.name}.png"
    draw(ladder, figures, picture)
    command = f"scripts/undertow pareto cases/{case} {ladder.name} --docs"
    machine = f"{made['threads']} threads"
    (root / f"{case}_{ladder.name}.md").write_text(page_text(ladder, figures, f"images/{picture.name}", command, machine))
    console(width=200).print(screen_table(ladder, figures))
    say(f"  table: {shown(root / f'{case}_{ladder.name}.md')}\n  picture: {shown(picture)}")
    if arguments.docs:
        shutil.copy(root / f"{case}_{ladder.name}.md", TOP / "docs")
        shutil.copy(picture, TOP / "docs" / "images")
        say(f"  docs/{case}_{ladder.name}.md is written")
    return CHECKS_FAILED if failed else DONE


def run_one(arguments, run, out):
    """`undertow run` in a process of its own, so that the CPU time of all its programs can be told."""
    command = [sys.executable, str(TOP / "scripts" / "undertow"), "run", arguments.case, "--out", str(out), "--force"]
    command += ["--level", run.level] if run.level else []
    for variant in run.variants:
        command += ["--with", variant]
    for assignment in run.set + arguments.set:
        command += ["--set", assignment]
    if run.backend:
        command += ["--backend", str(TOP / run.backend)]
    if arguments.threads:
        command += ["--threads", str(arguments.threads)]
    command += ["--quiet"] if arguments.quiet else []
    process = subprocess.Popen(command, stdout=None if not arguments.quiet else subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if out.exists():
        write_json(out / "cpu.json", {"cpu_s": round(usage.ru_utime + usage.ru_stime, 2)})
    return process.returncode


def add_command(commands, positive):
    sub = commands.add_parser("pareto", help="error against wall time over modelling choices of a case")
    sub.add_argument("case", metavar="CASE", help="a folder that holds case.toml and ladders/NAME.toml")
    sub.add_argument("ladder", nargs="?", default="", help="which ladder (default: the only one)")
    sub.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="overrides a key in every run")
    sub.add_argument("--threads", type=positive, help="of each run (default: every core)")
    sub.add_argument("--out", metavar="DIR", help="where the results go (default: results/pareto/CASE-LADDER)")
    sub.add_argument("--reuse", action="store_true", help="only runs that have no results yet")
    sub.add_argument("--docs", action="store_true", help="write table and picture into docs")
    sub.add_argument("--quiet", action="store_true", help="only the table")
    sub.set_defaults(do=pareto)
