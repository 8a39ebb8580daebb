"""An mp4 from the field files: numpy splat, matplotlib axes, ffmpeg."""
import shutil
import subprocess

import numpy as np

from .errors import UserError
from .fields import open_fields
from .paths import shown
from . import scene
from .pictures import FLUIDS, colorbar, draw_particles, draw_section, new_figure, plt, section_faces


def frame_extent(case, sph, fem):
    """What the camera sees: all that ever is inside the domain, with a margin."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for fields in (sph, fem):
        for step in ((0, len(fields) // 2, len(fields) - 1) if fields else ()):
            x = fields.read(step)[0]
            if len(x):
                low, high = np.minimum(low, x.min(axis=0)), np.maximum(high, x.max(axis=0))
    margin = 0.03 * max(high[0] - low[0], high[2] - low[2])
    return low[0] - margin, high[0] + margin, low[2] - margin, high[2] + margin


def speed_limits(sph):
    """0 to the 98th percentile of the fastest frames: a few jets must not darken the rest."""
    steps = np.unique(np.linspace(0, len(sph) - 1, 12).astype(int))
    tops = []
    for step in steps:
        velocity = sph.read(step, "velocity")[1]
        if velocity is not None and len(velocity):
            tops.append(np.percentile(np.linalg.norm(velocity, axis=1), 98))
    return 0.0, max(max(tops, default=1.0), 1e-6)


def find_section(fem):
    """Where a half model is cut, its faces and elements; None for a whole model."""
    if fem is None or fem.hexahedra is None:
        return None
    x = fem.read(0)[0]
    if x[fem.hexahedra][..., 1].min() < -1e-3:
        return None
    faces, element = section_faces(x, fem.hexahedra)
    return (faces, element) if len(faces) else None


def draw_structure(axes, fem, step, section, outer):
    x, plastic = fem.read(step, "plastic_strain")
    if section is None or plastic is None:
        scene.draw_structure(axes, x, *outer, edge=scene.line_width(fem.cells))
        return
    faces, element = section
    largest = 100 * fem.read(len(fem) - 1, "plastic_strain")[1].max()
    draw_section(axes, x, faces, 100 * plastic[element], (0, max(0.1, largest)), "YlOrRd", edge="#d8d8d8")
    size = np.minimum(np.ptp(x[faces][:, :, 0], axis=1), np.ptp(x[faces][:, :, 2], axis=1))
    thin = size < 0.3 * np.median(size)         # skirts and lids, else too thin to see
    draw_section(axes, x, faces[thin], None, color="#222222", edge="#222222")


def make_movie(out, case, path, fps=25, height=720):
    """Writes `path`; returns the number of frames."""
    if not shutil.which("ffmpeg"):
        raise UserError("ffmpeg is not installed: run scripts/setup.sh.")
    sph, fem = open_fields(out / "sph.vtkhdf"), open_fields(out / "fem.vtkhdf")
    if sph is None and fem is None:
        raise UserError(f"{shown(out)} has no field output (sph.vtkhdf, fem.vtkhdf) to make a movie from.")
    extent = frame_extent(case, sph, fem)
    limits = speed_limits(sph) if sph else (0, 1)
    ratio = np.clip((extent[1] - extent[0]) / (extent[3] - extent[2]), 0.8, 2.6)
    size = (2 * round(height * ratio / 2), 2 * round(height / 2))
    figure = new_figure((size[0] / 100, size[1] / 100))
    figure.set_dpi(100)
    # fonts have their size whatever the picture's: room for numbers and labels in pixels
    left, right, bottom, top = 62 / size[0], 1 - 115 / size[0], 50 / size[1], 1 - 38 / size[1]
    axes = figure.add_axes([left, bottom, right - left, top - bottom])
    bar, tall = right + 20 / size[0], top - bottom
    fluids = case["sph"]["fluid"] if sph else []
    if len(fluids) == 1:
        colorbar(figure, axes, limits, "speed [m/s]", cax=figure.add_axes([bar, bottom + 0.1 * tall, 18 / size[0], 0.8 * tall]))
    for k, fluid in enumerate(fluids[:2] if len(fluids) > 1 else []):    # each has its own colors
        colorbar(figure, axes, limits, f"{fluid['name']}: speed [m/s]", FLUIDS[k],
                 cax=figure.add_axes([bar, bottom + (0.55 - 0.52 * k) * tall, 18 / size[0], 0.42 * tall]))
    lead = sph or fem
    section = find_section(fem)
    outer = scene.outer_faces(fem.cells) if fem else None
    command = ["ffmpeg", "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgba",
               "-s", f"{size[0]}x{size[1]}", "-r", str(fps), "-i", "-", "-c:v", "libx264",
               "-pix_fmt", "yuv420p", "-crf", "20", "-movflags", "+faststart", str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE) as ffmpeg:
        for step, t in enumerate(lead.times):
            axes.clear()
            axes.set_title(f"{case['case']['title']}    t = {t:.3f} s")
            scene.draw_walls(axes, case, t, extent)
            if sph:
                x, velocity, fluid = sph.read(step, "velocity", "fluid")
                speed = np.linalg.norm(velocity, axis=1) if velocity is not None else np.zeros(len(x))
                if section is not None:     # half a model: what is at the cut, not what shines through behind
                    near = x[:, 1] < 2.5 * case["sph"]["spacing"]
                    x, speed, fluid = x[near], speed[near], None if fluid is None else fluid[near]
                draw_particles(axes, x, speed, extent, case["sph"]["spacing"], limits, width=size[0], fluid=fluid)
            if fem:
                draw_structure(axes, fem, fem.nearest(t), section, outer)
            axes.set_xlim(*extent[:2])
            axes.set_ylim(*extent[2:])
            axes.set_aspect("equal")
            axes.grid(False)
            scene.label_axes(axes)
            figure.canvas.draw()
            ffmpeg.stdin.write(figure.canvas.buffer_rgba())
        ffmpeg.stdin.close()
    plt.close(figure)
    if ffmpeg.returncode != 0:
        raise UserError(f"ffmpeg failed with code {ffmpeg.returncode}; its message stands above.")
    return len(lead)
