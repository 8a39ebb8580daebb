"""Where things are: the repository, the built programs, the results."""
import os
from pathlib import Path

from .errors import UserError

TOP = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("UNDERTOW_BUILD", TOP / "build"))
if not BUILD.is_absolute():
    BUILD = TOP / BUILD
RESULTS = TOP / "results"


def program(name):
    """Path of a built program; a sentence if it is not there."""
    path = BUILD / "bin" / name
    if not path.exists():
        raise UserError(f"{name} is not built (looked for {shown(path)}): run scripts/setup.sh first.")
    return path


def shown(path):
    """A path as short as it can be said from the current folder."""
    path = Path(path).resolve()
    try:
        return str(path.relative_to(Path.cwd()))
    except ValueError:
        return str(path)


def newest_results():
    """The result folder written to last, or None."""
    folders = [p for p in RESULTS.glob("*") if (p / "run.json").exists()]
    return max(folders, key=lambda p: (p / "run.json").stat().st_mtime, default=None)
