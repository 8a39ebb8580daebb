"""Joins what the programs wrote: summary.json and energy.csv."""
import numpy as np

from .history import read_history
from .results_folder import read_json

# What belongs to the run as a whole: taken from the coupler, or from the solver that ran alone.
COMMON = ("steps", "t", "outputs", "dt_min", "dt_mean", "dt_max", "limiters", "finish", "ended")
PARTS = {"sph": "sph", "fem": "fem", "coupler": "coupling"}


def part_of(summary, section):
    """A program's figures: its own section if it has one, and whatever stands beside it."""
    if summary is None:
        return {}
    own = {key: value for key, value in summary.items() if key not in (*PARTS, "coupling")}
    for name in (section, "coupler" if section == "coupling" else section):
        if isinstance(summary.get(name), dict):
            own.update(summary[name])
    return own


def join_summaries(out):
    """The parts as {"steps": ..., "sph": {...}, "fem": {...}, "coupling": {...}}."""
    parts = {section: part_of(read_json(out / f"summary.{program}.json"), section)
             for program, section in PARTS.items()}
    joined = {}
    for key in COMMON:
        for section in ("coupling", "sph", "fem"):
            if key in parts[section]:
                joined[key] = parts[section][key]
                break
    joined.update({section: part for section, part in parts.items() if part})
    if all(parts.values()):
        joined["coupling"] |= time_split(*(parts[name] for name in ("sph", "fem", "coupling")))
    return joined


def time_split(sph, fem, coupling):
    """Who waited, as fractions of the coupler's wall time. The slower solver never waits for the other
    one: what it waits is what the coupling itself costs (contact, messages), the overhead."""
    wall = coupling.get("wall_s") or 0
    if wall <= 0:
        return {}
    waits = {f"{name}_wait_fraction": part["wait_s"] / wall
             for name, part in (("sph", sph), ("fem", fem)) if "wait_s" in part}
    if len(waits) == 2:
        waits["overhead_fraction"] = min(waits.values())
    return waits


def join_energy(out):
    """energy.csv: columns of energy.sph.csv, energy.fem.csv and energy.interface.csv on the times of
    the first of them that exists, prefixed by their origin. Returns the path or None."""
    histories = [(name, read_history(out / f"energy.{name}.csv")) for name in ("sph", "fem", "interface")]
    histories = [(name, h) for name, h in histories if h is not None and len(h.get("t", ())) > 0]
    if not histories:
        return None
    t = histories[0][1]["t"]
    columns, names = [t], ["t [s]"]
    for name, history in histories:
        for key, values in history.items():
            if key == "t":
                continue
            plain = key if key.startswith(name + ".") else f"{name}.{key}"
            names.append(f"{plain} [{history.units[key]}]" if history.units[key] else plain)
            # The programs sample at the same interval but not at the same instants.
            columns.append(np.interp(t, history["t"], values, right=np.nan))
    path = out / "energy.csv"
    with open(path, "w") as file:
        file.write("# energies of all programs, interpolated to the times of energy."
                   f"{histories[0][0]}.csv\n")
        file.write(",".join(names) + "\n")
        for row in np.column_stack(columns):
            file.write(",".join(f"{value:.9g}" for value in row) + "\n")
    return path
