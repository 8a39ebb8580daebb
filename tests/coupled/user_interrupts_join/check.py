import json


def check(results):
    summary = json.loads((results / "summary.coupler.json").read_text())
    assert summary["finish"] == "interrupted", summary
    assert summary["exit_code"] == 130 and summary["step"] == 0, summary
