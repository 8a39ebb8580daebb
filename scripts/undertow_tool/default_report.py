"""The picture of a case that has no report.py of its own: four moments of its fields, and its histories."""
import re

import numpy as np

from .fields import open_fields
from .history import read_history
from .movie import frame_extent, speed_limits
from .pictures import FLUIDS, SPEED, colorbar, draw_particles, new_figure, plt
from .scene import draw_structure, draw_walls, label_axes, outer_faces

MOMENTS = 4
MOST_LINES = 6         # in a panel of histories
MOST_PANELS = 6
MEAN_OVER = 50         # parts of the span
COLORS = ("#d1495b", "#3b7dd8", "#2a9d8f", "#e09f3e", "#7b5ea7", "#555555")
WIDTH, COLUMN = 13.0, 5.4          # [inch] of the picture, of a moment in it


def prefixed(size, unit):
    """(factor, unit) that bring numbers of that size near 1 to 1000."""
    if unit not in ("m", "N", "Pa", "J", "N m") or not np.isfinite(size) or size == 0:
        return 1.0, unit
    for factor, prefix in ((1e-9, "G"), (1e-6, "M"), (1e-3, "k"), (1.0, ""), (1e3, "m"), (1e6, "u")):
        if size * factor >= 0.5:
            return (factor, prefix + unit) if unit != "m" or prefix in ("", "m", "u") else (1.0, unit)
    return 1e6, "u" + unit


def panel(title, history, names, label=lambda name: name):
    """(title, unit, [(label, t, values)]), those that change most; None when nothing does."""
    lines = [(np.nanmax(history[n]) - np.nanmin(history[n]), n) for n in names if np.isfinite(history[n]).any()]
    lines = sorted((line for line in lines if line[0] > 0), reverse=True)
    if not lines:
        return None
    largest = lines[0][0]
    kept = {n for change, n in lines[:MOST_LINES] if change > 1e-6 * largest}
    if len(lines) > MOST_LINES:
        title += f" ({MOST_LINES} of {len(lines)})"
    return title, history.units[lines[0][1]], [(label(n), history["t"], history[n]) for n in names if n in kept]


def of_bodies(history, case):
    """Forces on the bodies of an SPH run, all fluids together, as columns NAME.fx and NAME.fz."""
    for body in (case["sph"] or {}).get("body", []):
        for axis in ("fx", "fz"):
            parts = [c for c in history if re.fullmatch(re.escape(body["name"]) + r"(\.[^.]+)?\." + axis, c)]
            if parts:
                history[f"{body['name']}.{axis}"] = sum(history[c] for c in parts)
                history.units[f"{body['name']}.{axis}"] = "N"
    return [f"{body['name']}.{axis}" for body in (case["sph"] or {}).get("body", []) for axis in ("fx", "fz")
            if f"{body['name']}.{axis}" in history]


def panels_of(out, case):
    found = []
    forces, patches, nodes, energy = (read_history(out / name) for name in (
        "forces.csv", "patches.csv", "fem.history.csv", "energy.csv"))
    if forces is not None and case["coupled"]:
        names = [c for c in forces if re.fullmatch(r"[^.]+\.f[xz]", c)]
        found.append(panel("Contact forces on the structure", forces, names))
    elif forces is not None and not any(gauge["kind"] == "force" for gauge in case["sph"]["gauge"]):
        found.append(panel("Forces on bodies", forces, of_bodies(forces, case)))
    if nodes is not None:
        moved = [c for c in nodes if re.search(r"\.u[xyz]$", c)]
        found.append(panel("Displacements", nodes, moved))
    for gauges in (read_history(path) for path in sorted(out.glob("gauges*.csv"))):     # a gauge may have its own interval
        for unit, title in (("m", "Gauges: levels and fronts"), ("Pa", "Gauges: pressures"), ("m3/s", "Gauges: flux"),
                            ("m2/s", "Gauges: flux"), ("N", "Gauges: forces")):
            found.append(panel(title, gauges, [c for c in gauges if c != "t" and gauges.units[c] == unit]))
    if patches is not None:
        found.append(panel("Patches: mean pressure of contact", patches, [c for c in patches if patches.units[c] == "Pa"]))
    if energy is not None:
        names = [c for c in ("sph.kinetic", "fem.kinetic", "fem.internal") if c in energy]
        found.append(panel("Energies", energy, names, lambda n: {"sph": "fluid, ", "fem": "structure, "}[n[:3]] + n[4:]))
    return [p for p in found if p][:MOST_PANELS]


def is_rough(values):
    """Rows that differ from the middle of their neighbors by a hundredth of the range, in the mean: noise, no resolved motion."""
    values = values[np.isfinite(values)]
    if len(values) < 4 * MEAN_OVER:
        return False
    return np.mean(np.abs(values[1:-1] - (values[:-2] + values[2:]) / 2)) > 0.01 * np.ptp(values)


def moving_mean(values):
    """Over a fiftieth of the rows; towards the ends over fewer."""
    half = max(1, len(values) // (2 * MEAN_OVER))
    total = np.concatenate([[0.0], np.cumsum(np.nan_to_num(values))])
    at = np.arange(len(values))
    reach = np.minimum(half, np.minimum(at, len(values) - 1 - at))
    return (total[at + reach + 1] - total[at - reach]) / (2 * reach + 1)


def draw_panel(axes, title, unit, lines):
    size = max(np.nanmax(np.abs(values)) for _, _, values in lines)
    factor, unit = prefixed(size, unit)
    for (label, t, values), color in zip(lines, COLORS):
        noisy = unit[-1:] in "Na" and is_rough(values)
        if noisy:               # as it is, with its mean before it
            axes.plot(t, factor * values, color=color, linewidth=0.5, alpha=0.35)
        axes.plot(t, factor * (moving_mean(values) if noisy else values), color=color, linewidth=1.2,
                  label=label + (f", mean of {np.ptp(t) / MEAN_OVER:.2g} s" if noisy else ""))
    axes.set(title=title, xlabel="t [s]", ylabel=f"[{unit}]")
    axes.margins(x=0)
    axes.legend(loc="best")


class Scene:
    """Fields of a run, drawn at one moment after the other in the same scales."""

    def __init__(self, out, case):
        self.case = case
        self.sph, self.fem = open_fields(out / "sph.vtkhdf"), open_fields(out / "fem.vtkhdf")
        self.lead = self.sph or self.fem
        if self.lead is None:
            return
        self.extent = frame_extent(case, self.sph, self.fem)
        self.speed = speed_limits(self.sph) if self.sph else None
        self.stress = None
        if self.fem:
            self.faces, self.owners = outer_faces(self.fem.cells)
            tops = [np.percentile(v, 99) for v in (self.fem.read(k, "von_mises")[1] for k in self.moments(12, self.fem))
                    if v is not None and len(v)]
            self.stress = max(tops, default=0) or None

    def moments(self, count, fields=None):
        return np.unique(np.linspace(0, len(fields or self.lead) - 1, count).round().astype(int))

    def draw(self, axes, step):
        t = self.lead.times[step]
        axes.set_title(f"t = {t:.4g} s")
        draw_walls(axes, self.case, t, self.extent)
        if self.sph:
            x, velocity, fluid = self.sph.read(step, "velocity", "fluid")
            speed = np.linalg.norm(velocity, axis=1) if velocity is not None else np.zeros(len(x))
            draw_particles(axes, x, speed, self.extent, self.case["sph"]["spacing"], self.speed, fluid=fluid)
        if self.fem:
            x, stress = self.fem.read(self.fem.nearest(t), "von_mises")
            factor = prefixed(self.stress or 0, "Pa")[0]
            draw_structure(axes, x, self.faces, self.owners, None if stress is None or not self.stress else factor * stress,
                           (0, factor * (self.stress or 1)), edge=0)
        axes.set_xlim(*self.extent[:2])
        axes.set_ylim(*self.extent[2:])
        axes.set_aspect("equal")
        axes.grid(False)
        label_axes(axes)

    def scales(self, figure, axes):
        """Color bars beside all moments, one for each fluid."""
        if self.stress:
            factor, unit = prefixed(self.stress, "Pa")
            colorbar(figure, axes, (0, factor * self.stress), f"von Mises stress [{unit}]", "magma", shrink=0.8, aspect=30)
        fluids = (self.case["sph"] or {}).get("fluid", []) if self.sph else []
        for k, fluid in enumerate(fluids[:3]):
            one = len(fluids) == 1
            colorbar(figure, axes, self.speed, "speed [m/s]" if one else f"{fluid['name']}: speed [m/s]",
                     SPEED if one else FLUIDS[k % len(FLUIDS)], shrink=0.8, aspect=30)


def draw_report(out, case):
    """Writes report.png; returns whether there was anything to draw."""
    scene, panels = Scene(out, case), panels_of(out, case)
    if scene.lead is None and not panels:
        return False
    columns = {1: 1, 2: 2, 4: 2}.get(len(panels), 3)
    rows = -(-len(panels) // columns)
    steps = scene.moments(MOMENTS) if scene.lead else []
    tall = 0
    if len(steps):
        ratio = (scene.extent[1] - scene.extent[0]) / (scene.extent[3] - scene.extent[2])
        tall = -(-len(steps) // 2) * (np.clip(COLUMN / ratio, 1.0, 5.0) + 0.6)
    figure = new_figure((WIDTH, tall + 2.6 * rows + 0.5))
    figure.set_layout_engine("constrained")
    figure.suptitle(case["case"]["title"], x=0.01, ha="left", fontsize=13, fontweight="bold")
    heights = [h for h in (tall, 2.6 * rows) if h]
    parts = list(np.atleast_1d(figure.subfigures(len(heights), 1, height_ratios=heights)))
    if len(steps):
        part = parts.pop(0)
        grid = np.atleast_1d(part.subplots(-(-len(steps) // 2), min(2, len(steps)), squeeze=False)).ravel()
        for axes, step in zip(grid, steps):
            scene.draw(axes, step)
        for axes in grid[len(steps):]:
            axes.set_visible(False)
        scene.scales(part, list(grid))
    if panels:
        grid = parts[0].subplots(rows, columns, squeeze=False).ravel()
        for axes, (title, unit, lines) in zip(grid, panels):
            draw_panel(axes, title, unit, lines)
        for axes in grid[len(panels):]:
            axes.set_visible(False)
    figure.savefig(out / "report.png")
    plt.close(figure)
    return True
