"""Two layers of different particles at rest: weight on the floor, pressure through the interface, what moves, what mixes."""
from undertow_tool.verify.two_layers import draw, report

__all__ = ["draw", "report"]
