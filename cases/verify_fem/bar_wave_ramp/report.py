"""A bar pressed on its end: see scripts/undertow_tool/verify/bar_wave.py."""
from undertow_tool.verify.bar_wave import draw, report

__all__ = ["draw", "report"]
