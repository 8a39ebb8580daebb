"""Checkpoints of the Python backends: fem.npz in the folder of the set (docs/checkpoints.md), every number in
the precision it is computed in, so that a resumed run has the bits of the whole one.

What has a state names the attributes that steps change: `changing = ("q", "q_dot")`. They may be numbers, arrays,
tuples of arrays, None, or things that have a state themselves.
"""
import hashlib
import io
import json
import os
import pathlib
import re
import zipfile

import numpy as np

FILE = "fem.npz"


class CheckpointError(Exception):
    """A sentence: what of the set does not fit, and what to do."""


def state_of(thing, place=""):
    """{"q": array, "books.work": array, ...}; None is left out."""
    state = {}
    for name in thing.changing:
        value = getattr(thing, name)
        if hasattr(value, "changing"):
            state.update(state_of(value, f"{place}{name}."))
        elif isinstance(value, tuple):
            state.update({f"{place}{name}.{k}": np.asarray(part) for k, part in enumerate(value)})
        elif value is not None:
            state[place + name] = np.asarray(value)
    return state


def restore(thing, state, place=""):
    """The inverse: plain numbers stay plain numbers."""
    def plain(array):
        return array.item() if array.ndim == 0 else array

    for name in thing.changing:
        key = place + name
        part = getattr(thing, name, None)       # None: not there before it is restored
        if hasattr(part, "changing"):
            restore(part, state, key + ".")
        elif key + ".0" in state:
            setattr(thing, name, tuple(plain(state[f"{key}.{k}"])
                                       for k in range(sum(other.startswith(key + ".") for other in state))))
        else:
            setattr(thing, name, plain(state[key]) if key in state else None)


def write(out, name, table, parts):
    """Writes out/checkpoints/`name`/fem.npz whole or not at all; parts: {"structure": thing, ...}, table: that of
    the case. Returns the name and the SHA-256 for CHECKPOINT_ACK."""
    if not re.fullmatch(r"[A-Za-z0-9_-]+", name):
        raise CheckpointError(f"a checkpoint cannot be named '{name}': letters, digits, _ and - only")
    folder = pathlib.Path(out) / "checkpoints" / name
    folder.mkdir(parents=True, exist_ok=True)
    arrays = {f"{part}/{key}": value for part, thing in parts.items() for key, value in state_of(thing).items()}
    bytes_of = io.BytesIO()
    np.savez(bytes_of, table=json.dumps(table), **arrays)
    aside = folder / (FILE + ".part")
    try:
        with open(aside, "wb") as file:
            file.write(bytes_of.getbuffer())
            file.flush()
            os.fsync(file.fileno())
        aside.replace(folder / FILE)
    except OSError:
        aside.unlink(missing_ok=True)
        raise
    directory = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(directory)
    finally:
        os.close(directory)
    return FILE, hashlib.sha256(bytes_of.getbuffer()).hexdigest()


def read(folder, table):
    """The state in the set `folder`, whose manifest must name this very file: restore_parts() takes it."""
    folder = pathlib.Path(folder)
    try:
        files = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))["files"]
        told = next(file for file in files if file["who"] == "fem")
    except OSError as error:
        raise CheckpointError(f"{folder} holds no manifest.json ({error.strerror}): this is no whole set of "
                              "checkpoints; give one of the folders in RESULTS/checkpoints that has it") from None
    except (ValueError, KeyError, TypeError, StopIteration):
        raise CheckpointError(f"{folder}/manifest.json is damaged or names no file of fem; resume from another "
                              "set") from None
    path = folder / FILE
    if pathlib.PurePath(told.get("file", "")).name != FILE:
        raise CheckpointError(f"{folder} was written with another structure (its file is {told.get('file')}, that "
                              f"of the Python backends {FILE}); resume with that one")
    data = path.read_bytes() if path.exists() else b""
    if hashlib.sha256(data).hexdigest() != told.get("sha256"):
        raise CheckpointError(f"{path} is not the file that the manifest names (another SHA-256): it was changed, "
                              "damaged or taken from another set; resume from another set")
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as file:
            state = {key: file[key] for key in file.files}
    except (ValueError, zipfile.BadZipFile) as error:
        raise CheckpointError(f"{path} cannot be read ({error}); resume from another set") from None
    refuse_other_table(json.loads(str(state.pop("table"))), table, path)
    return state


def restore_parts(state, **parts):
    for part, thing in parts.items():
        restore(thing, {key.partition("/")[2]: value for key, value in state.items() if key.startswith(part + "/")})


def refuse_other_table(then, now, path):
    now = json.loads(json.dumps(now))
    for key in sorted({*then, *now}):
        if then.get(key) != now.get(key):
            raise CheckpointError(f"the key {key} of the backend's table is {now.get(key)}, but the checkpoint {path} "
                                  f"was written with {then.get(key)}; put it back, or start anew")
