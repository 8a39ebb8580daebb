"""A case, read by the rules of the solvers: undertow_case does the work."""
import json
import subprocess
from pathlib import Path

from .errors import UserError
from .paths import program


def layer_options(arguments):
    """--level, --with and --set as the programs take them."""
    options = []
    if arguments.level:
        options += ["--level", arguments.level]
    for variant in arguments.variants:
        options += ["--with", variant]
    for assignment in arguments.set:
        options += ["--set", assignment]
    return options


def resolve(path, options):
    """The resolved case as a dict. Raises UserError with the reader's own sentence."""
    done = subprocess.run([program("undertow_case"), str(path), *options],
                          capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise UserError(done.stderr.strip() or f"undertow_case ended with code {done.returncode}.")
    case = json.loads(done.stdout)
    case["folder"] = str(Path(case["file"]).resolve().parent)
    return case


def result_name(case, arguments):
    """NAME, NAME-LEVEL, NAME-LEVEL-VARIANT...: so that variants lie side by side."""
    return "-".join([case["case"]["name"]] + ([arguments.level] if arguments.level else [])
                    + list(arguments.variants))
