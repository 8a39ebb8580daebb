"""Slide on a bucket foundation, beside the few numbers that Wang et al. 2024 print.

The run is half a model: forces and moments here are doubled. Time counts from the moment at which the
slide is let go. Nothing is tuned; the paper leaves width, depth and domain open, so its numbers are
told beside ours and judge nothing. What is judged: the start, the budgets, the balance of momentum.
"""
from pathlib import Path

import numpy as np

from undertow_tool import pictures
from undertow_tool.checks import check, relative
from undertow_tool.fields import open_fields
from undertow_tool.history import read_history
from undertow_tool.pictures import EXPERIMENT, OURS, draw_particles, draw_section, plt, section_faces

WHOLE = 2.0                # the run computes half
WINDOW = 0.01              # [s] centered mean that peaks are read from: two sound crossings of the bucket
TOUCH = 500.0              # [N] force of the slide that counts as contact: 1 % of the paper's peak
PAPER = {"contact": 0.35, "peak": 59e3, "peak_time": 0.49, "displacement": 0.019, "displacement_time": 0.51,
         "late": 1.0, "late_force": 5e3, "late_displacement": 0.011}
STILL = 1e-4               # [m] the bar for the start: lid displacement without a slide
WATER_INK, SLIDE_INK = "#2b6cb0", "#b5793a"
LEAST_PLASTIC = 0.1        # [%] plastic strain shown at least; more if there is more


class Run:
    def __init__(self, folder, case):
        self.folder, self.case, self.setup = folder, case, case["report"]
        self.start = self.setup["start"]
        self.fluids = [f["name"] for f in case["sph"]["fluid"] if any(k["fluid"] == f["name"] for k in case["sph"]["fill"])]
        self.has_slide = "slide" in self.fluids
        self.one_fluid = len(case["sph"]["fluid"]) == 1      # then forces.csv has no columns per fluid
        self.forces = read_history(folder / "forces.csv")
        self.history = read_history(folder / "fem.history.csv")

    def force(self, phase=None, axis="x", surface="bucket"):
        """(t [s], force on the whole bucket [N]) of a phase, or of all."""
        f = self.forces
        name = f"{surface}.{phase}.f{axis}" if phase and not self.one_fluid else f"{surface}.f{axis}"
        return f["t"] - self.start, WHOLE * f[name]

    def lid(self, axis):
        """(t [s], displacement of the lid's center [m])."""
        h = self.history
        return h["t"] - self.start, h[f"lid.u{axis}"]

    def rotation(self):
        """(t [s], rotation about y [rad])."""
        return self.history["t"] - self.start, self.history["bucket.ry"]


def smooth(t, values, window=WINDOW):
    """Centered mean over `window`."""
    step = np.median(np.diff(t))
    half = max(0, int(round(0.5 * window / step)))
    if half == 0:
        return values
    padded = np.concatenate([np.full(half, values[0]), values, np.full(half, values[-1])])
    return np.convolve(padded, np.full(2 * half + 1, 1 / (2 * half + 1)), mode="valid")


def at(t, values, when):
    return float(np.interp(when, t, values))


def impact_checks(run):
    if not run.has_slide:
        return []
    t, slide = run.force("slide")
    _, all_phases = run.force()
    total = smooth(t, all_phases)
    rows = []
    touched = np.flatnonzero(smooth(t, slide) > TOUCH)
    if len(touched):
        rows.append(relative("slide reaches the bucket", float(t[touched[0]]), PAPER["contact"], unit="s",
                             note=f"its force passes {TOUCH:g} N"))
    after = t > 0
    peak = int(np.argmax(np.where(after, total, -np.inf)))
    rows.append(relative("peak force in x", float(total[peak]), PAPER["peak"], unit="N", note=f"mean of {1000 * WINDOW:g} ms"))
    rows.append(relative("time of the peak force", float(t[peak]), PAPER["peak_time"], unit="s"))
    th, x = run.lid("x")
    size = np.hypot(x, run.lid("z")[1])
    top = int(np.argmax(size))
    rows.append(relative("largest displacement of the lid", float(size[top]), PAPER["displacement"], unit="m"))
    rows.append(relative("time of the largest displacement", float(th[top]), PAPER["displacement_time"], unit="s"))
    if t[-1] >= PAPER["late"] + 0.02:
        rows.append(relative("force in x at 1.0 s", at(t, smooth(t, all_phases, 0.05), PAPER["late"]), PAPER["late_force"],
                             unit="N", note="mean of 50 ms"))
        rows.append(relative("displacement of the lid at 1.0 s", at(th, size, PAPER["late"]), PAPER["late_displacement"], unit="m"))
    return rows


def start_checks(run):
    """Before the slide moves, and for good where there is none, the lid stands still."""
    t, x = run.lid("x")
    size = np.hypot(x, run.lid("z")[1])
    if run.has_slide:
        moving = run.start - run.case["start"]["settle"]      # the ramp already pushes water
        before = t <= -moving
        if not before.any():
            return []
        value = float(size[before].max())
        return [check("lid displacement while all is held", value, 0.0, value, STILL, unit="m")]
    value = float(size.max())
    last = t > t[-1] - 0.25
    drift = float(np.polyfit(t[last], size[last], 1)[0]) if last.sum() > 10 else float("nan")
    return [check("lid displacement without a slide", value, 0.0, value, STILL, unit="m",
                  note=f"{t[-1] + run.start - run.case['start']['settle']:.2f} s after settling"),
            check("drift of the lid over the last 0.25 s", drift, 0.0, unit="m/s")]


def audit_checks(summary):
    rows = []
    residual = (summary.get("coupling") or {}).get("momentum_residual")
    if residual is not None:
        # Contact forces are quantized and summed as integers: equal and opposite but for the last rounding.
        rows.append(check("momentum given by the fluids less received by the structure", residual, 0.0, residual, 1e-9,
                          note="relative"))
    budget = (summary.get("sph") or {}).get("budget") or {}
    if budget:
        lost = float(budget["unaccounted_particles"])
        rows.append(check("particles neither there nor removed", lost, 0.0, lost, 0.0))
        rest = (budget["mass_start_kg"] - budget["mass_end_kg"] - budget["mass_removed_kg"]) / budget["mass_start_kg"]
        rows.append(check("mass neither there nor removed", rest, 0.0, rest, 1e-9, note="relative"))
        gone = sum(f["removed"] for f in summary["sph"]["fluid"].values())
        rows.append(check("particles that left the domain", float(gone), 0.0))
    return rows


def draw_snapshot(view, run, sph, fem, when, top):
    step = sph.nearest(when + run.start)
    spacing = run.case["sph"]["spacing"]
    x, velocity, fluid = sph.read(step, "velocity", "fluid")
    near = x[:, 1] < 2.5 * spacing
    speed = np.linalg.norm(velocity, axis=1)
    extent = (-6.2, 4.2, -3.2, 3.2)
    alone = pictures.FLUIDS[1 if run.has_slide else 0]
    draw_particles(view, x[near], speed[near], extent, spacing, (0, 8), cmap=alone,
                   fluid=None if fluid is None else fluid[near])
    if fem is not None:
        draw_ground(view, fem, fem.nearest(sph.times[step]), top)
    view.set(xlim=extent[:2], ylim=extent[2:], title=f"{sph.times[step] - run.start:.2f} s", xlabel="x [m]", ylabel="z [m]")
    view.set_xticks(range(-6, 5, 2))
    view.set_yticks([-2, 0, 2])


def largest_plastic(fem):
    """[%] at the end of the run: plastic strain never shrinks."""
    plastic = fem.read(len(fem) - 1, "plastic_strain")[1] if fem is not None else None
    return max(LEAST_PLASTIC, 100 * float(plastic.max())) if plastic is not None else LEAST_PLASTIC


def draw_ground(view, fem, step, top):
    x, plastic = fem.read(step, "plastic_strain")
    faces, element = section_faces(x, fem.hexahedra)
    values = 100 * plastic[element] if plastic is not None else None
    draw_section(view, x, faces, values, (0, top), "YlOrRd", color="#f3efe6", edge="#d8d8d8")
    steel = np.ptp(x[faces][:, :, 0], axis=1).min() if len(faces) else 0
    thin = np.minimum(np.ptp(x[faces][:, :, 0], axis=1), np.ptp(x[faces][:, :, 2], axis=1)) < 0.03
    if steel and thin.any():
        draw_section(view, x, faces[thin], None, color="#222222", edge="#222222")


def draw_plan(view, run, sph, when):
    """The slide from above; water is left out."""
    step = sph.nearest(when + run.start)
    x, velocity, fluid = sph.read(step, "velocity", "fluid")
    slide = np.ones(len(x), bool) if fluid is None else fluid == 1
    x, velocity = x[slide], velocity[slide]
    width = run.case["sph"]["fill"][0]["box"]["max"][1]
    extent = (-6.2, 4.2, 0.0, width)
    both = np.concatenate([x, x * [1, -1, 1]])
    speed = np.linalg.norm(velocity, axis=1)
    whole = (extent[0], extent[1], -width, width)
    if len(x):
        draw_particles(view, both, np.concatenate([speed, speed]), whole, run.case["sph"]["spacing"], (0, 8),
                       cmap=pictures.FLUIDS[1], above=True)
    view.add_patch(plt.Circle((0, 0), 1.0, facecolor="none", edgecolor="#222222", linewidth=1.6, zorder=4))
    view.set(xlim=whole[:2], ylim=whole[2:], aspect="equal", title=f"slide from above, {when:g} s", xlabel="x [m]", ylabel="y [m]")


def draw_forces(view, run):
    t, total = run.force()
    view.plot(t, smooth(t, total) / 1000, color=OURS, label="all")
    if run.has_slide:
        for phase, ink in (("water", WATER_INK), ("slide", SLIDE_INK)):
            if run.one_fluid:
                continue
            view.plot(t, smooth(t, run.force(phase)[1]) / 1000, color=ink, linewidth=1.0, label=phase)
        paper = [(PAPER["peak_time"], PAPER["peak"]), (PAPER["late"], PAPER["late_force"])]
        view.plot(*zip(*[(a, b / 1000) for a, b in paper]), "o", color=EXPERIMENT, markersize=5, label="paper", zorder=5)
        view.axvline(PAPER["contact"], color="#aaaaaa", linewidth=1, linestyle="--", label="paper's contact")
    view.set(title="Force on the bucket in x", xlabel="t [s]", ylabel="[kN]")
    view.legend()


def draw_lid(view, run):
    for axis, ink in (("x", OURS), ("z", "#2a9d8f")):
        t, u = run.lid(axis)
        view.plot(t, 1000 * u, color=ink, label=f"lid, {axis} [mm]")
    t, r = run.rotation()
    view.plot(t, 1000 * r, color="#7b5ea7", linewidth=1.0, label="rotation about y [mrad]")
    if run.has_slide:
        paper = [(PAPER["displacement_time"], PAPER["displacement"]), (PAPER["late"], PAPER["late_displacement"])]
        view.plot(*zip(*[(a, 1000 * b) for a, b in paper]), "o", color=EXPERIMENT, markersize=5, label="paper", zorder=5)
    view.set(title="Displacement", xlabel="t [s]", ylabel="[mm], [mrad]")
    view.legend()


def draw(run, path):
    sph, fem = open_fields(run.folder / "sph.vtkhdf"), open_fields(run.folder / "fem.vtkhdf")
    figure = pictures.new_figure((14, 11.5))
    outer = figure.add_gridspec(3, 1, height_ratios=(1.15, 1.15, 0.9), hspace=0.25, left=0.05, right=0.97, top=0.93, bottom=0.05)
    top = largest_plastic(fem)
    times = [t for t in run.setup["snapshots"] if sph is not None and t + run.start <= sph.times[-1] + 0.026]
    for k, when in enumerate(times[:4]):
        grid = outer[k // 2].subgridspec(1, 2, wspace=0.08)
        draw_snapshot(figure.add_subplot(grid[k % 2]), run, sph, fem, when, top)
    bottom = outer[2].subgridspec(1, 3, wspace=0.22)
    draw_forces(figure.add_subplot(bottom[0]), run)
    draw_lid(figure.add_subplot(bottom[1]), run)
    if run.has_slide and len(times) > 2:
        draw_plan(figure.add_subplot(bottom[2]), run, sph, times[2])
    keys = [plt.Line2D([], [], marker="o", linestyle="", color=ink, label=label) for ink, label in
            ((WATER_INK, "water"), (SLIDE_INK, "slide (light: 8 m/s)"), ("#fd8d3c", f"clay, plastic strain (dark: {top:.2g} %)"))]
    figure.legend(handles=keys, loc="upper right", ncol=3, bbox_to_anchor=(0.97, 0.985))
    figure.suptitle(f"{run.case['case']['title']}   dx = {1000 * run.case['sph']['spacing']:g} mm",
                    x=0.05, y=0.985, ha="left", fontsize=13, fontweight="bold")
    figure.savefig(path)
    plt.close(figure)


def report(results_dir, case, summary):
    run = Run(Path(results_dir), case)
    rows = impact_checks(run) + start_checks(run) + audit_checks(summary)
    draw(run, run.folder / "report.png")
    return rows
