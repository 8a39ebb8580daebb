"""Triaxial test: see scripts/undertow_tool/verify/triaxial.py."""
from undertow_tool.verify.triaxial import draw, report

__all__ = ["draw", "report"]
