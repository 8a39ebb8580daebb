#!/usr/bin/python3
"""Draws processes.png: the three programs and what they exchange in a step."""
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

INK, WATER, STEEL, WIRE = "#22303c", "#cfe4f7", "#e4e0d8", "#fbeecb"


def box(axes, x, color, title, lines):
    axes.add_patch(FancyBboxPatch((x, 1.0), 2.7, 2.6, boxstyle="round,pad=0.02,rounding_size=0.12",
                                  facecolor=color, edgecolor=INK, linewidth=1.4))
    axes.text(x + 1.35, 3.25, title, ha="center", va="center", fontsize=14, weight="bold",
              color=INK, family="monospace")
    for k, line in enumerate(lines):
        axes.text(x + 1.35, 2.72 - 0.40 * k, line, ha="center", va="center", fontsize=10.5, color=INK)


def arrow(axes, start, end, y, text, above=True):
    axes.add_patch(FancyArrowPatch((start, y), (end, y), arrowstyle="-|>", mutation_scale=16,
                                   linewidth=1.5, color=INK))
    axes.text((start + end) / 2, y + (0.12 if above else -0.14), text, ha="center",
              va="bottom" if above else "top", fontsize=9.5, color=INK)


figure, axes = plt.subplots(figsize=(12.4, 4.1))
axes.set_xlim(0, 13.0)
axes.set_ylim(0.1, 4.4)
axes.axis("off")
box(axes, 0.15, WATER, "sph_solver", ["water and slides", "pair sums while it waits", "own rigid walls, gates",
                                      "stable step: sound"])
box(axes, 5.15, WIRE, "coupler", ["contact: search, penalty,", "friction; exact sums", "one agreed step",
                                  "audit and records"])
box(axes, 10.15, STEEL, "fem_solver", ["structure and soil", "elements while it waits", "supports, loads",
                                       "stable step: hexahedron"])
arrow(axes, 2.95, 5.05, 2.75, "x, v near the wall, dt")
arrow(axes, 5.05, 2.95, 1.75, "contact forces, dt", above=False)
arrow(axes, 10.05, 7.95, 2.75, "x, v of the surface, dt")
arrow(axes, 7.95, 10.05, 1.75, "nodal forces, dt", above=False)
axes.text(6.5, 4.08, "one case file  ->  three programs, one synchronized step, ZeroMQ", ha="center",
          fontsize=12, color=INK)
axes.text(6.5, 0.42, "each solver also runs alone; any program that speaks the protocol can stand in for "
          "fem_solver", ha="center", fontsize=10.5, style="italic", color=INK)
figure.savefig(Path(__file__).with_suffix(".png"), dpi=110, bbox_inches="tight")
