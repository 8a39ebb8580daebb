import json


def check(results):
    """The summary of a run that failed: the cause, the exit code, the step."""
    summary = json.loads((results / "summary.coupler.json").read_text())
    assert summary["finish"] == "failed" and summary["exit_code"] == 3, summary
    assert summary["step"] == summary["steps"] == 200, summary
    assert summary["cause"].startswith("E_PEER_LOST: sph vanished in step 200"), summary
