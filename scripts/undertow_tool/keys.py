"""undertow keys: the key pairs of a run across hosts, see protocol/wire/curve_keys.hpp."""
import os
import re
from pathlib import Path

from .errors import DONE, UserError
from .paths import shown


def write_pair(folder, name):
    import zmq
    public, secret = (key.decode() for key in zmq.curve_keypair())
    secret_file = folder / f"{name}.key"
    with open(os.open(secret_file, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as file:
        file.write(f"public {public}\nsecret {secret}\n")
    (folder / f"{name}.pub").write_text(f"public {public}\n")


def keys(arguments):
    folder = Path(arguments.folder)
    names = ["coupler", *(arguments.names or ["sph", "fem"])]
    for name in names:
        if not re.fullmatch(r"[A-Za-z0-9_.-]{1,64}", name):
            raise UserError(f"{name!r} is no name of a participant: 1 to 64 letters, digits, _ - and .")
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    there = [name for name in names if (folder / f"{name}.key").exists() or (folder / f"{name}.pub").exists()]
    if there:
        raise UserError(f"{shown(folder)} has keys of {', '.join(there)} already; choose another folder, or remove "
                        "them first.")
    for name in names:
        write_pair(folder, name)
    print(f"{shown(folder)}: keys of {', '.join(names)}. Copy every .pub file to every host, and each .key file to "
          "the one host of its program; then give the programs --keys FOLDER.")
    return DONE


def add_command(commands):
    sub = commands.add_parser("keys", help="make keys for a run across hosts")
    sub.add_argument("folder", metavar="FOLDER")
    sub.add_argument("names", metavar="NAME", nargs="*", help="participants (default: sph fem)")
    sub.set_defaults(do=keys)
