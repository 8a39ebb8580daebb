"""Modes of a cantilever: see scripts/undertow_tool/verify/cantilever.py."""
from undertow_tool.verify.cantilever import draw, report

__all__ = ["draw", "report"]
