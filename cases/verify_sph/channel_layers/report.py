"""Two layers in a channel: profile and wall stress against the exact ones."""
from undertow_tool.verify.shear_flow import LayeredChannel, report_of

report, draw = report_of(LayeredChannel)

__all__ = ["draw", "report"]
