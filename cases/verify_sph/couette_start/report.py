"""A lid that starts: profile and wall stress against the exact ones."""
from undertow_tool.verify.shear_flow import StartingCouette, report_of

report, draw = report_of(StartingCouette)

__all__ = ["draw", "report"]
