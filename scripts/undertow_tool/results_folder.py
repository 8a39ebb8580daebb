"""Result folders: made, moved aside, never lost by accident."""
import json
import os
import platform
import shutil
import subprocess
import time

from .errors import UserError
from .paths import TOP, shown


def is_results(folder):
    return (folder / "run.json").exists()


def prepare(folder, replace):
    """An empty folder. Earlier results move aside to NAME.1, NAME.2, ... or go if `replace`.

    Returns the line to tell the user, or None. Anything that is no result folder is refused.
    """
    told = None
    if folder.exists() and not folder.is_dir():
        raise UserError(f"--out {shown(folder)}: this is a file; name a folder.")
    if folder.exists() and any(folder.iterdir()):
        if not is_results(folder):
            raise UserError(f"{shown(folder)} holds something other than results of this program; "
                            "choose another --out.")
        if replace:
            shutil.rmtree(folder)
            told = f"earlier results in {shown(folder)} replaced (--force)"
        else:
            number = 1
            while (aside := folder.with_name(f"{folder.name}.{number}")).exists():
                number += 1
            folder.rename(aside)
            told = f"earlier results moved aside to {shown(aside)}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        trial = folder / ".trial"               # said now, not after minutes of work
        trial.touch()
        trial.unlink()
    except OSError as error:
        raise UserError(f"--out {shown(folder)}: no results can be written there ({error.strerror}); choose another "
                        "folder.") from None
    return told


def describe_run(command, threads):
    """What run.json records, so that a result can be told from another and made again."""
    def git(*arguments):
        if shutil.which("git") is None:     # a bare machine has none, and no run needs it
            return None
        done = subprocess.run(["git", "-C", str(TOP), *arguments], capture_output=True, text=True, check=False)
        return done.stdout.strip() if done.returncode == 0 else None

    model = None
    try:
        with open("/proc/cpuinfo") as info:
            model = next((line.split(":", 1)[1].strip() for line in info if line.startswith("model name")), None)
    except OSError:
        pass
    return {"command": command, "started": time.strftime("%Y-%m-%d %H:%M:%S%z"),
            "commit": git("rev-parse", "HEAD"), "modified": bool(git("status", "--porcelain", "-uno")),
            "processor": model, "cores": os.cpu_count(), "threads": threads,
            "system": platform.platform()}


def write_json(path, value):
    """Written aside and renamed. OSError names the file, also where the disk is full."""
    aside = path.with_suffix(path.suffix + ".tmp")
    try:
        aside.write_text(json.dumps(value, indent=2) + "\n")
        aside.rename(path)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(path)) from None


def read_json(path):
    """None when the file is not there or is half written."""
    try:
        return json.loads(path.read_text())
    except (FileNotFoundError, json.JSONDecodeError):
        return None
