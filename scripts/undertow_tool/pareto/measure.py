"""Errors and costs of the runs of a ladder."""
import numpy as np

from ..history import read_history
from ..results_folder import read_json

SAMPLES = 2000      # points in time at which curves are compared


def figures_of(ladder, run, folder, reference_folder):
    """{"errors": {name: fraction or None}, "cost": {...}} of a finished run."""
    summary = read_json(folder / "summary.json")
    errors = {curve.name: curve_error(curve, folder, reference_folder) for curve in ladder.curves}
    for check in ladder.checks:
        rows = [row for row in summary.get("checks", []) if row["name"].startswith(check.name)]
        errors[check.title] = abs(rows[0]["error"]) if rows and rows[0]["error"] is not None else None
    return {"name": run.name, "note": run.note, "errors": errors, "cost": cost_of(summary, folder)}


def cost_of(summary, folder):
    sph, fem = summary.get("sph") or {}, summary.get("fem") or {}
    limiters = summary.get("limiters") or sph.get("limiters") or fem.get("limiters") or {}
    cpu = read_json(folder / "cpu.json")
    return {"wall_s": summary["wall_s"], "cpu_s": cpu["cpu_s"] if cpu else None,
            "steps": summary.get("steps") or sph.get("steps") or fem.get("steps"),
            "dt_mean": summary.get("dt_mean") or sph.get("dt_mean") or fem.get("dt_mean"),
            "limiter": max(limiters, key=limiters.get, default=""),
            "particle_steps_per_s": sph.get("particle_steps_per_s"),
            "element_steps_per_s": fem.get("element_steps_per_s")}


def curve_error(curve, folder, reference_folder):
    """Of a curve against the reference run's, over its largest value (peak and mean: their relative change).

    None where the run has no such history: a rigid wall has no displacement.
    """
    ours, theirs = samples(curve, folder), samples(curve, reference_folder)
    if ours is None or theirs is None:
        return None
    end = min(ours[0][-1], theirs[0][-1])
    t = np.linspace(max(ours[0][0], theirs[0][0]), end, SAMPLES)
    a, b = (np.interp(t, *smoothed(*history, curve.window)) for history in (ours, theirs))
    scale = np.abs(b).max()
    if scale == 0:
        return None
    if curve.measure == "peak":
        return float(np.abs(a).max() / scale - 1)
    if curve.measure == "mean":
        return float(a.mean() / b.mean() - 1)
    return float(np.sqrt(np.mean((a - b) ** 2)) / scale)


def samples(curve, folder):
    history = read_history(folder / curve.file)
    names = [curve.column] if isinstance(curve.column, str) else curve.column
    column = next((name for name in names if history is not None and name in history), None)
    return (history["t"], history[column]) if column and len(history["t"]) > 1 else None


def smoothed(t, values, window):
    """Mean over window [s] centered at each time, by the integral of the piecewise linear history."""
    if window <= 0:
        return t, values
    integral = np.concatenate(([0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(t))))
    left, right = np.clip(t - window / 2, t[0], t[-1]), np.clip(t + window / 2, t[0], t[-1])
    return t, (np.interp(right, t, integral) - np.interp(left, t, integral)) / (right - left)


def best_of(figures, name):
    """Names of the runs that no other beats in wall time and in the error `name` at once."""
    rated = [(row["cost"]["wall_s"], abs(row["errors"][name]), row["name"]) for row in figures
             if row["errors"].get(name) is not None]
    return {who for wall, error, who in rated
            if not any(w <= wall and e <= error and (w, e) != (wall, error) for w, e, _ in rated)}
