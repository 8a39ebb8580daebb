"""A lid over grease: profile and wall stress against the exact ones."""
from undertow_tool.verify.shear_flow import SteadyCouette, report_of

report, draw = report_of(SteadyCouette)

__all__ = ["draw", "report"]
