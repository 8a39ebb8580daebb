"""What a ladder asks for: cases/NAME/ladders/LADDER.toml.

    title = "..."                   # of table and picture
    about = "..."                   # a paragraph above the table
    level = "quick"                 # of every run, and so
    set = ["time.end=0.5"]
    reference = "explicit"          # the run that the curves are compared with

    [[run]]
    name = "implicit wall"
    with = ["implicit_wall"]        # level, set, backend: of this run alone, beside those of all
    note = "..."
    twin = false                    # true: the reference again, with something that should not matter changed

    [[curve]]                       # error of a history against the reference run's
    name = "force on the wall"
    file = "forces.csv"
    column = "wall.fx"              # or several names, of which a run has one
    window = 5e-3                   # [s] centered mean taken of both before they are compared
    measure = "curve"               # or "peak", "mean"

    [[check]]                       # error of a row of the case's own table, such as one against an experiment
    name = "front X = x/H, RMS"     # the row whose name starts so
    title = "front, RMS"
"""
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

from ..errors import UserError
from ..paths import shown

MEASURES = "curve", "peak", "mean"


@dataclass
class Run:
    name: str
    level: str = ""
    variants: list = field(default_factory=list)
    set: list = field(default_factory=list)
    backend: str = ""
    note: str = ""
    twin: bool = False

    @property
    def folder(self):
        return "".join(c if c.isalnum() else "_" for c in self.name)


@dataclass
class Curve:
    name: str
    file: str
    column: object              # name, or names of which the first that is there counts
    window: float = 0.0         # [s]
    measure: str = "curve"


@dataclass
class Check:
    name: str
    title: str


@dataclass
class Ladder:
    name: str
    title: str
    about: str
    reference: str
    runs: list
    curves: list
    checks: list


def folder_of(case):
    path = Path(case)
    return path if path.is_dir() else path.parent


def ladder_names(case):
    return sorted(path.stem for path in (folder_of(case) / "ladders").glob("*.toml"))


def read_ladder(case, name):
    """The ladder `name` of a case. Raises UserError with the file and the key that is wrong."""
    names = ladder_names(case)
    if not names:
        raise UserError(f"{case} has no ladders: they are files {folder_of(case)}/ladders/NAME.toml.")
    if name not in names:
        raise UserError(f"{case} has no ladder \"{name}\": it has {', '.join(names)}.")
    path = folder_of(case) / "ladders" / f"{name}.toml"
    try:
        table = tomllib.loads(path.read_text())
    except tomllib.TOMLDecodeError as error:
        raise UserError(f"{shown(path)}: {error}.") from error
    return ladder_from(table, name, shown(path))


def ladder_from(table, name, where):
    known(table, ("title", "about", "level", "set", "reference", "run", "curve", "check"), where)
    runs = []
    for entry in table.get("run", []):
        known(entry, ("name", "level", "with", "set", "backend", "note", "twin"), f"{where}, [[run]]")
        need(entry, ("name",), f"{where}, [[run]]")
        runs.append(Run(entry["name"], entry.get("level", table.get("level", "")), entry.get("with", []),
                        table.get("set", []) + entry.get("set", []), entry.get("backend", ""), entry.get("note", ""),
                        entry.get("twin", False)))
    if len({run.folder for run in runs}) < len(runs) or not runs:
        raise UserError(f"{where}: it needs [[run]] tables whose names differ in more than spaces.")
    curves = []
    for entry in table.get("curve", []):
        known(entry, ("name", "file", "column", "window", "measure"), f"{where}, [[curve]]")
        need(entry, ("name", "file", "column"), f"{where}, [[curve]]")
        curves.append(Curve(**entry))
        if curves[-1].measure not in MEASURES:
            raise UserError(f"{where}, [[curve]] {entry['name']}: measure is one of {', '.join(MEASURES)}.")
    checks = []
    for entry in table.get("check", []):
        known(entry, ("name", "title"), f"{where}, [[check]]")
        need(entry, ("name",), f"{where}, [[check]]")
        checks.append(Check(entry["name"], entry.get("title", entry["name"])))
    reference = table.get("reference", "")
    if curves and reference not in [run.name for run in runs]:
        raise UserError(f"{where}: reference = \"{reference}\" must be the name of a [[run]], since there are curves.")
    if not curves and not checks:
        raise UserError(f"{where}: it compares nothing; give it a [[curve]] or a [[check]].")
    return Ladder(name, table.get("title", name), table.get("about", "").strip(), reference, runs, curves, checks)


def known(table, keys, where):
    for key in table:
        if key not in keys:
            raise UserError(f"{where}: there is no key \"{key}\"; there are {', '.join(keys)}.")


def need(table, keys, where):
    for key in keys:
        if key not in table:
            raise UserError(f"{where}: \"{key}\" is missing.")
