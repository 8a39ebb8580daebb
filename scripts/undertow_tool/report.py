"""Runs a case's own report.py: report(results_dir, resolved_case, summary) -> list of checks. A case without one gets
a picture of its fields and histories."""
import importlib.util
from pathlib import Path

from .results_folder import read_json, write_json


def run_report(out, case, summary):
    """Fills summary["checks"]; a case without report.py has none, but a picture."""
    script = Path(case["folder"]) / "report.py"
    checks = []
    if script.exists():
        spec = importlib.util.spec_from_file_location(f"report_of_{case['case']['name']}", script)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        checks = module.report(out, case, summary)
    else:
        from .default_report import draw_report
        try:
            draw_report(Path(out), case)
        except Exception as error:      # noqa: BLE001: nobody asked for this picture, so the run does not fail of it
            print(f"report.png could not be drawn: {type(error).__name__}: {error}")
    summary["checks"] = checks
    return checks


def refresh(out):
    """The summary of a finished run with its checks computed anew from the result files."""
    summary, case = read_json(out / "summary.json"), read_json(out / "case.json")
    if summary is None or case is None:
        return None
    if (Path(case["folder"]) / "report.py").exists():
        run_report(out, case, summary)
        write_json(out / "summary.json", summary)
    return summary
