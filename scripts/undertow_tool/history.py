"""CSV histories: '#' notes, a line of columns such as "t [s]", rows."""
import numpy as np


class History(dict):
    """Column name without unit -> array; `units` and `notes` beside it."""

    def __init__(self):
        super().__init__()
        self.units = {}
        self.notes = []


def read_history(path):
    """Reads a history; an incomplete last row (a killed run) is dropped. None if there is no file."""
    try:
        lines = path.read_text().splitlines()
    except FileNotFoundError:
        return None
    history = History()
    rows = []
    names = None
    for line in lines:
        if line.startswith("#"):
            history.notes.append(line[1:].strip())
        elif names is None:
            names = [column.strip() for column in line.split(",")]
        else:
            cells = line.split(",")
            if len(cells) == len(names):
                rows.append([float(cell) if cell.strip() else np.nan for cell in cells])
    if names is None:
        return None
    table = np.array(rows, dtype=float).reshape(-1, len(names))
    for index, name in enumerate(names):
        plain, _, unit = name.partition(" [")
        history[plain] = table[:, index]
        history.units[plain] = unit.rstrip("]")
    return history
