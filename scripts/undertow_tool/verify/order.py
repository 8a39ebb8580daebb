"""Observed order of convergence."""
import numpy as np


def errors_of(rungs, name):
    """(dx, |error|) of a row over the resolutions of a ladder, coarsest first; variants left out."""
    pairs = []
    for rung in rungs:
        if rung.variant:
            continue
        row = next((r for r in rung.figures["checks"] if r["name"] == name), None)
        if row and row["error"] is not None:
            pairs.append((rung.figures["spacing"], abs(row["error"])))
    pairs.sort(reverse=True)
    return np.array(pairs).reshape(-1, 2)


def observed_order(rungs, name):
    """Slope of log|error| over log dx by least squares; None with fewer than two errors or one that is 0.

    It means something where the error is still one of resolution; the reader sees the errors beside it.
    """
    pairs = errors_of(rungs, name)
    if len(pairs) < 2 or np.any(pairs[:, 1] == 0) or len(set(pairs[:, 0])) < 2:
        return None
    return float(np.polyfit(np.log(pairs[:, 0]), np.log(pairs[:, 1]), 1)[0])


def orders_of(rungs, settings):
    """Row -> observed order, of the rows that [report] converges names; without it, of all."""
    return {name: observed_order(rungs, name) for name in settings.get("converges", row_names(rungs))}


def unknown_rows(rungs, settings):
    """Names in [report] that no row of the results has: mistyped, a gate would never be judged."""
    rows = row_names(rungs)
    named = [*(settings.get("gates") or {}), *settings.get("converges", []), *settings.get("headline", [])]
    return [name for name in named if name not in rows]


def row_names(rungs):
    """Names of all rows, in order of first appearance."""
    names = []
    for rung in rungs:
        names += [row["name"] for row in rung.figures["checks"] if row["name"] not in names]
    return names
