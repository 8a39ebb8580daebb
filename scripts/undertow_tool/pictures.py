"""Pictures of particles and meshes without a display: a numpy splat inside matplotlib axes."""
import matplotlib

matplotlib.use("Agg")

import matplotlib.colors  # noqa: E402
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.collections import PolyCollection  # noqa: E402

SPEED = "viridis"
INK = "#222222"
WATER, STRUCTURE, EXPERIMENT, OURS = "#3b7dd8", "#8a8f98", "#444444", "#d1495b"

STYLE = {
    "font.size": 9, "axes.titlesize": 10, "axes.titleweight": "bold", "axes.titlelocation": "left",
    "axes.spines.top": False, "axes.spines.right": False, "axes.edgecolor": "#888888",
    "axes.labelcolor": INK, "text.color": INK, "xtick.color": "#555555", "ytick.color": "#555555",
    "axes.grid": True, "grid.color": "#e6e6e6", "grid.linewidth": 0.7, "legend.frameon": False,
    "legend.fontsize": 8, "figure.dpi": 110, "savefig.dpi": 130, "lines.linewidth": 1.5,
}


# Of the first, second, ... fluid of a case, from slow to fast.
FLUIDS = [matplotlib.colors.LinearSegmentedColormap.from_list(name, colors) for name, colors in (
    ("water", ("#cfe3f5", "#86b6e0", "#2b6cb0", "#0b3c6f")),
    ("slide", ("#8a6a45", "#b5793a", "#e09f3e", "#f6d186")))]


def colors_of(values, limits, cmap=SPEED, fluid=None):
    """(n, 3) of 0 to 255: by value, and where the case has several fluids each in its own colors."""
    shade = np.clip((values - limits[0]) / (limits[1] - limits[0] or 1), 0, 1)
    if fluid is None or len(np.unique(fluid)) < 2:
        return (plt.get_cmap(cmap)(shade)[:, :3] * 255).astype(np.float32)
    colors = np.zeros((len(values), 3), dtype=np.float32)
    for k in np.unique(fluid).astype(int):
        its = fluid == k
        colors[its] = FLUIDS[k % len(FLUIDS)](shade[its])[:, :3] * 255
    return colors


def splat(points, depth, colors, extent, radius, width):
    """Shaded discs of `radius` [m] painted from far to near into an RGBA image of `width` pixels.

    points (n, 2) [m]; depth (n), larger is nearer; colors (n, 3); extent (left, right, bottom, top) [m].
    """
    left, right, bottom, top = extent
    scale = width / (right - left)                       # [pixel/m]
    height = max(1, int(round((top - bottom) * scale)))
    image = np.zeros((height * width, 4), dtype=np.uint8)
    image[:, :3] = 255
    if len(points) == 0:
        return image.reshape(height, width, 4)
    order = np.argsort(depth, kind="stable")
    color = colors[order]
    column = np.floor((points[order, 0] - left) * scale).astype(int)
    row = np.floor((top - points[order, 1]) * scale).astype(int)
    r = max(1.0, radius * scale)
    reach = int(np.ceil(r))
    # All pixels of a particle at once, particle by particle in depth: numpy keeps the last write of
    # an index, so nearer particles cover farther ones.
    offsets = [(i, j) for i in range(-reach, reach + 1) for j in range(-reach, reach + 1)
               if i * i + j * j <= r * r]
    light = np.array([1.0 - 0.35 * (i * i + j * j) / (r * r) for i, j in offsets], dtype=np.float32)
    di, dj = np.array(offsets).T
    rows, columns = row[:, None] + di, column[:, None] + dj
    inside = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
    shaded = (color[:, None, :] * light[None, :, None]).astype(np.uint8)
    index = (rows * width + columns)[inside]
    image[index, :3] = shaded[inside]
    image[index, 3] = 255
    return image.reshape(height, width, 4)


def draw_particles(axes, x, values, extent, spacing, limits, cmap=SPEED, width=900, fluid=None, above=False):
    """A side view (x-z, seen along +y from y = -infinity) into axes; `above`: a plan (x-y) from above."""
    points, depth = (x[:, [0, 1]], x[:, 2]) if above else (x[:, [0, 2]], -x[:, 1])
    image = splat(points, depth, colors_of(values, limits, cmap, fluid), extent, 0.62 * spacing, width)
    axes.imshow(image, extent=extent, interpolation="bilinear", zorder=2, aspect="equal")
    axes.set_xlim(extent[0], extent[1])
    axes.set_ylim(extent[2], extent[3])
    axes.grid(False)


def draw_mesh(axes, x, hexahedra, magnify=1.0, displacement=None, color=STRUCTURE):
    """The mesh's facets in side view. `magnify` exaggerates the displacement."""
    shown = x if displacement is None else x + (magnify - 1) * displacement
    front = hexahedra[:, [0, 1, 5, 4]]                   # the facet towards -y of a block's elements
    axes.add_collection(PolyCollection(shown[front][:, :, [0, 2]], facecolor=color, edgecolor="white",
                                       linewidth=0.3, zorder=3))


def section_faces(x, hexahedra, y=0.0, near=1e-3):
    """The mesh's faces that lie in the plane y: (n, 4) nodes and (n) elements."""
    corner = np.array(((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)))
    faces = hexahedra[:, corner]                         # (elements, 6, 4)
    lies = np.all(np.abs(x[faces][..., 1] - y) < near, axis=2)
    element, side = np.nonzero(lies)
    return faces[element, side], element


def draw_section(axes, x, faces, values=None, limits=(0, 1), cmap="magma_r", color=STRUCTURE, edge="white"):
    """Faces in side view, in one color or by value."""
    polygons = PolyCollection(x[faces][:, :, [0, 2]], linewidth=0.3, edgecolor=edge, zorder=1)
    if values is None:
        polygons.set_facecolor(color)
    else:
        polygons.set(array=values, cmap=cmap, clim=limits)
    axes.add_collection(polygons)


def colorbar(figure, axes, limits, label, cmap=SPEED, **options):
    mapping = plt.cm.ScalarMappable(plt.Normalize(*limits), cmap)
    bar = figure.colorbar(mapping, ax=axes, label=label, **options)
    bar.outline.set_visible(False)
    return bar


def new_figure(size):
    plt.rcParams.update(STYLE)
    return plt.figure(figsize=size)
