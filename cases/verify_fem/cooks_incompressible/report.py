"""Cook's membrane: see scripts/undertow_tool/verify/cooks_membrane.py."""
from undertow_tool.verify.cooks_membrane import draw, report

__all__ = ["draw", "report"]
