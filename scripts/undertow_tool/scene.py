"""A case in side view (x-z): its rigid walls, structure and particles, whatever it is made of."""
import numpy as np
from matplotlib.collections import PolyCollection

from .pictures import STRUCTURE

WALL = "#c9c2b8"
SIDES = {9: ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
         6: ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)), 5: ((0, 1, 2, 3),), 4: ((0, 1, 2),)}
ROUND = 48             # corners of a drawn circle


def outer_faces(cells):
    """Faces of solids that one cell has alone, and shells: nodes (n, 4), a triangle's last one twice, and cells (n)."""
    faces, owners = [np.zeros((0, 4), dtype=int)], [np.zeros(0, dtype=int)]
    for kind, (numbers, nodes) in cells.items():
        for side in SIDES[kind]:
            face = nodes[:, side]
            faces.append(face if len(side) == 4 else face[:, [0, 1, 2, 2]])
            owners.append(numbers)
    faces, owners = np.concatenate(faces), np.concatenate(owners)
    if len(faces) == 0:
        return faces, owners
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    alone = np.sort(first[count == 1])
    return faces[alone], owners[alone]


def line_width(cells):
    """Edges of a coarse mesh are worth seeing; those of a fine one would cover it."""
    return 0.3 if sum(len(numbers) for numbers, _ in cells.values()) < 4000 else 0


def draw_structure(axes, x, faces, owners, values=None, limits=(0, 1), cmap="magma", edge=0.3):
    """Outer faces seen along +y, the nearest last; by `values` of the cells [n_cells] or in one color."""
    if len(faces) == 0:
        return
    order = np.argsort(-x[faces][..., 1].mean(axis=1), kind="stable")
    corners = x[faces[order]][..., [0, 2]]
    # seen from the edge a face has no area: its line shows a thin wall
    polygons = PolyCollection(corners, linewidth=edge, edgecolor="white", zorder=3)
    thin = np.ptp(x[faces][..., 0]) < 0.02 * max(np.ptp(x[faces][..., 2]), 1e-300) or \
        np.ptp(x[faces][..., 2]) < 0.02 * max(np.ptp(x[faces][..., 0]), 1e-300)
    if values is None:
        polygons.set_facecolor(STRUCTURE)
        if thin:
            polygons.set(edgecolor=STRUCTURE, linewidth=2)
    else:
        polygons.set(array=values[owners[order]], cmap=cmap, clim=limits)
        if thin:
            polygons.set(edgecolor="face", linewidth=2)
    axes.add_collection(polygons)


def outline(body):
    """Corners (n, 2) of a rigid body's section in x-z; None where that is not known (STL, a slanted cylinder)."""
    if "profile" in body and body["profile"]:
        return np.array(body["profile"], dtype=float)
    if body.get("box"):
        a, b = body["box"]["min"], body["box"]["max"]
        return np.array([(a[0], a[2]), (b[0], a[2]), (b[0], b[2]), (a[0], b[2])], dtype=float)
    if body.get("radius"):
        a, b, r = np.array(body["from"]), np.array(body["to"]), body["radius"]
        axis = (b - a) / np.linalg.norm(b - a)
        if abs(axis[1]) > 0.999:
            angle = np.linspace(0, 2 * np.pi, ROUND, endpoint=False)
            return np.column_stack([a[0] + r * np.cos(angle), a[2] + r * np.sin(angle)])
        if abs(axis[1]) < 1e-3:
            side = r * np.array([-axis[2], axis[0]])
            a, b = a[[0, 2]], b[[0, 2]]
            return np.array([a + side, b + side, b - side, a - side])
    return None


def place_of(body, t):
    """How far a body has moved [m] (x, z) by t; None where a formula or a table says it."""
    if body.get("displacement") or body.get("motion") or body.get("angle"):
        return None
    stop = np.inf if body.get("stop") is None else body["stop"]
    return max(0.0, min(t, stop) - body["start"]) * np.array(body["velocity"], dtype=float)[[0, 2]]


def draw_walls(axes, case, t, extent):
    """Rigid planes and bodies of [sph], as far as their place at t is known."""
    left, right, bottom, top = extent
    sph = case["sph"] or {}
    for plane in sph.get("plane", []):
        (px, _, pz), (nx, ny, nz) = plane["point"], plane["normal"]
        if abs(ny) > 0.5:
            continue
        along = np.array([-nz, nx]) * 10 * (right - left + top - bottom)
        start, end = np.array([px, pz]) - along, np.array([px, pz]) + along
        axes.plot([start[0], end[0]], [start[1], end[1]], color="#8a8378", linewidth=1, zorder=1, scalex=False, scaley=False)
    for body in sph.get("body", []):
        corners, moved = outline(body), place_of(body, t)
        if corners is None or moved is None:
            continue
        corners = corners + moved
        if body.get("inside"):
            axes.plot(*np.vstack([corners, corners[:1]]).T, color="#8a8378", linewidth=1, zorder=1, scalex=False, scaley=False)
        else:
            axes.fill(*corners.T, facecolor=WALL, edgecolor="#8a8378", linewidth=0.6, zorder=1)


def label_axes(axes):
    axes.set(xlabel="x [m]", ylabel="z [m]")
