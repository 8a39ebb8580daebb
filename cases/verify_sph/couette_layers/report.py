"""Two layers under a lid: profile and wall stress against the exact ones."""
from undertow_tool.verify.shear_flow import LayeredCouette, report_of

report, draw = report_of(LayeredCouette)

__all__ = ["draw", "report"]
