"""The smaller offer decides; steps land on the output times without a sliver."""
import json


def check(results):
    summary = json.loads((results / "summary.coupler.json").read_text())
    assert summary["dt_max"] <= 3.7e-5 * (1 + 1e-12), summary["dt_max"]
    assert summary["dt_min"] >= 0.8 * 3.7e-5, summary["dt_min"]
    assert summary["t"] == 0.02, summary["t"]
    shares = summary["limiters"]
    assert shares["fem: dummy"] > 80, shares
