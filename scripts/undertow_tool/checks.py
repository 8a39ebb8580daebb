"""Checks: a quantity of the run against its reference, with a tolerance that says where it is from."""
import math


def check(name, value, reference, error=None, tolerance=None, unit="", note=""):
    """One row of the table. `error` and `tolerance` are in the same measure; no tolerance, no verdict."""
    known = value is not None and math.isfinite(value)
    verdict = None
    if tolerance is not None:
        verdict = bool(known and error is not None and abs(error) <= tolerance)
    return {"name": name, "value": value if known else None, "reference": reference, "error": error,
            "tolerance": tolerance, "ok": verdict, "unit": unit, "note": note}


def relative(name, value, reference, tolerance=None, unit="", note=""):
    """Error relative to the reference."""
    known = value is not None and math.isfinite(value) and reference
    error = (value - reference) / abs(reference) if known else None
    return {**check(name, value, reference, error, tolerance, unit, note), "measure": "relative"}


def in_band(name, value, reference, low, high, unit="", note=""):
    """A value against the scatter of repeated experiments: `low` to `high`."""
    row = relative(name, value, reference, None, unit, note)
    row["band"] = [low, high]
    row["ok"] = bool(row["value"] is not None and low <= value <= high)
    return row


def all_ok(checks):
    return all(row["ok"] is not False for row in checks)
