"""A picture per verification: what it looks like, error against spacing, error against cost."""
import importlib.util

import numpy as np

from .. import pictures
from ..pictures import plt
from ..results_folder import read_json
from .ladder import measured_of
from .order import errors_of, orders_of, row_names

COLORS = ("#3b7dd8", "#d1495b", "#2a9d8f", "#8a5a9e", "#c98b1b")
MARKS = ("o", "s", "^", "D", "v")


def own_panel(folder):
    """draw(axes, runs) of the verification's report.py, or None; runs: a list of (label, Measured)."""
    spec = importlib.util.spec_from_file_location("report_for_picture", folder / "report.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return getattr(module, "draw", None)


def shown_rows(rungs):
    """Rows with a gate first: they are what the case is about. At most five fit."""
    def gated(name):
        return any(r["name"] == name and r["tolerance"] is not None for rung in rungs for r in rung.figures["checks"])
    with_errors = [name for name in row_names(rungs) if len(errors_of(rungs, name))]
    return sorted(with_errors, key=lambda name: not gated(name))[:len(COLORS)]


def draw_ladder(title, settings, folder, rungs, outs, path):
    draw = own_panel(folder)
    figure = pictures.new_figure((11 if draw else 7.6, 3.5))
    axes = figure.subplots(1, 3 if draw else 2)
    if draw:
        runs = [(rung.label, measured_of(out, read_json(out / "case.json"), read_json(out / "summary.json")))
                for rung, out in zip(rungs, outs) if not rung.variant]
        draw(axes[0], runs)
    against_dx, against_cost = axes[-2], axes[-1]
    orders = orders_of(rungs, settings)
    for k, name in enumerate(shown_rows(rungs)):
        pairs = errors_of(rungs, name)
        order = orders.get(name)
        label = name + (f", order {order:.1f}" if order is not None else "")
        style = {"color": COLORS[k], "marker": MARKS[k], "markersize": 4.5, "linewidth": 1.2}
        against_dx.plot(pairs[:, 0], np.maximum(pairs[:, 1], 1e-16), label=label, **style)
        costs = [(r.figures["cpu_s"], abs(row["error"]), r.variant) for r in rungs for row in r.figures["checks"]
                 if row["name"] == name and row["error"] is not None]
        plain = sorted((cost, error) for cost, error, variant in costs if not variant)
        if plain:
            against_cost.plot(*np.maximum(np.array(plain), 1e-16).T, **style)
        for cost, error, variant in costs:
            if variant:
                against_cost.plot(cost, max(error, 1e-16), marker=MARKS[k], color=COLORS[k], markerfacecolor="white",
                                  markersize=5, linestyle="none")
                against_cost.annotate(variant, (cost, max(error, 1e-16)), fontsize=6, xytext=(3, 2),
                                      textcoords="offset points")
    for panel, label in ((against_dx, "spacing [m]"), (against_cost, "CPU time [s]")):
        panel.set(xscale="log", yscale="log", xlabel=label)
    # the spacings of the levels: on an axis of less than a decade the usual marks run into each other
    levels = sorted({float(dx) for line in against_dx.lines for dx in line.get_xdata()})
    against_dx.set_xticks(levels, [f"{dx:.3g}" for dx in levels], fontsize=7)
    against_dx.tick_params(axis="x", which="minor", bottom=False, labelbottom=False)
    against_dx.set(ylabel="error", title=title if not draw else "")
    against_dx.legend(fontsize=6.5, loc="best")
    if draw:
        axes[0].set_title(title)
    figure.tight_layout()
    figure.savefig(path, dpi=100, bbox_inches="tight")
    plt.close(figure)
