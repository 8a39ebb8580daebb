"""undertow verify: runs ladders, judges them, keeps figures and pictures."""
import traceback
from pathlib import Path

from ..case import resolve
from ..errors import CHECKS_FAILED, DONE, RunFailed, UserError
from ..paths import RESULTS, shown
from ..results_folder import describe_run, write_json
from ..table import console
from .ladder import folder_of, known_verifications, ladder_of, named, run_rung, solver_of
from .order import orders_of, row_names, unknown_rows


def say(text):
    print(text, flush=True)


def verify(arguments):
    root = (Path(arguments.out) if arguments.out else RESULTS / "verify").absolute()
    if arguments.list:
        for name, folder in known_verifications().items():
            case = resolve(folder, [])
            say(f"{name:24} {case['case']['title']} ({', '.join(case['report'].get('ladder', []))})")
        return DONE
    good = True
    names = [name for target in arguments.names for name in named(target)]
    for target in names or (known_verifications() if not arguments.docs else []):
        folder = folder_of(target)
        good &= verify_one(folder, arguments, root)
    if arguments.docs:
        from .pages import write_pages

        for page in write_pages(root):
            say(f"{shown(page)} has the table of {shown(root)}")
    return DONE if good else CHECKS_FAILED


def verify_one(folder, arguments, root):
    """Runs one ladder; true if every row keeps its gate or is a known defect."""
    from .pages import ladder_table, row_state
    from .picture import draw_ladder

    root.mkdir(parents=True, exist_ok=True)
    case = resolve(folder, [])
    rungs, outs, failed = [], [], []
    planned = ladder_of(folder, arguments.quick, arguments.long)
    levels = list(dict.fromkeys(rung.level for rung in planned))
    for level in arguments.level:
        if level not in levels:
            raise UserError(f"{shown(folder)}: --level {level} is not among the levels to run: {', '.join(levels)}.")
    for rung in planned:
        if arguments.level and rung.level not in arguments.level:
            continue
        if not arguments.quiet:
            say(f"{folder.name}: {rung.label} ...")
        try:
            outs.append(run_rung(folder, rung, arguments.set, arguments.variants, arguments.threads or 1, root,
                                 arguments.reuse))
            rungs.append(rung)
        except RunFailed as error:
            failed.append(rung.label)
            say(f"{folder.name}, {rung.label}: {error}")
        except (UserError, KeyboardInterrupt):
            raise
        except Exception:      # noqa: BLE001: whatever a verification's own script raises
            traceback.print_exc()
            failed.append(rung.label)
            say(f"{folder.name}, {rung.label}: its report.py failed (above)")
    settings = case["report"]
    if rungs and (unknown := unknown_rows(rungs, settings)):
        raise UserError(f"{shown(folder)}/case.toml: [report] names \"{unknown[0]}\", but report.py makes no such row: "
                        f"it has {', '.join(row_names(rungs))}.")
    result = {"name": folder.name, "solver": solver_of(case), "title": case["case"]["title"], "exact": settings.get("exact", ""),
              "gates_from": settings.get("gates_from", ""), "defects": settings.get("defects", {}),
              "made": describe_run(["verify", folder.name], arguments.threads or 1), "set": arguments.set,
              "orders": orders_of(rungs, settings),
              "rungs": [{"level": r.level, "variant": r.variant, "label": r.label, "figures": r.figures} for r in rungs],
              "failed_runs": failed}
    states = [(rung.label, row["name"], row_state(row)) for rung in rungs for row in rung.figures["checks"]]
    result["ok"] = not failed and all(state != "FAILS" for _, _, state in states)
    write_json(root / f"{folder.name}.json", result)
    if rungs and not arguments.quick:
        draw_ladder(result["title"], settings, folder, rungs, outs, root / f"{folder.name}.png")
    if rungs:
        console(width=230).print(ladder_table(result))
    for label, name, state in states:
        if state == "mended":
            say(f"{folder.name}, {label}: {name} keeps its gate although it is listed as a known defect: if it does so at "
                "every level, take it out of [report.defects].")
        elif state == "defect":
            say(f"{folder.name}, {label}: known defect, {name}: {settings['defects'][name]['why']}")
    return result["ok"]


def add_command(commands, positive):
    sub = commands.add_parser("verify", help="exact solutions: error and cost of one solver alone, over resolutions")
    sub.add_argument("names", nargs="*", metavar="NAME", help="folders of cases/verify_sph and cases/verify_fem, or other folders; `channel` stands for all channel_*; default: all")
    sub.add_argument("--list", action="store_true", help="name them and end")
    sub.add_argument("--quick", action="store_true", help="without the finest level, variants and pictures")
    sub.add_argument("--long", action="store_true", help="the levels that [report] lists as long as well")
    sub.add_argument("--level", action="append", default=[], help="only this level; may be repeated")
    sub.add_argument("--with", dest="variants", action="append", default=[], metavar="VARIANT",
                     help="a [variant.NAME] for every run; may be repeated")
    sub.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="overrides a key in every run")
    sub.add_argument("--threads", type=positive, help="per run (default: 1, so that CPU times compare)")
    sub.add_argument("--out", metavar="DIR", help="where the results go (default: results/verify)")
    sub.add_argument("--reuse", action="store_true", help="judge the results that are there, without running")
    sub.add_argument("--docs", action="store_true", help="write the tables of docs/validation_sph.md and docs/validation_fem.md; without names: only that")
    sub.add_argument("--quiet", action="store_true", help="only tables")
    sub.set_defaults(do=verify)
