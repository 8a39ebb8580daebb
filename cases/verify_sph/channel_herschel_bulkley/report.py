"""Plane Poiseuille flow: profile and wall stress against the exact ones."""
from undertow_tool.verify.shear_flow import Channel, report_of

report, draw = report_of(Channel)

__all__ = ["draw", "report"]
