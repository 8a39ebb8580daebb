#!/usr/bin/python3
"""Mesh recipe of the bucket case: half a bucket in half a box of clay, and the rigid sea bed around it.

    mesh.py [--angular 20] [--depth-layers 12] [--width 2.5] FILE.msh

The clay leaves the skirt a slot: its nodes lie GAP off both faces and off the tip, where the slot
closes. Volume sets clay, bucket; facet sets mud_line and bed (coupled; bed belongs to no element),
clay_skirt and bucket_skirt (contact with each other), bucket_wet (coupled), far, symmetry.
"""
import argparse

import numpy as np

RADIUS, WALL, DEPTH, HEIGHT = 1.0, 0.02, 2.0, 0.5      # [m] bucket: outside, skirt, buried, exposed
GAP = 0.005                                            # [m] between the meshes of skirt and clay
SQUARE = 2.0                                           # [m] half width of the block around the bucket
BOX_X, BOX_Y, BOX_Z = 4.0, 4.0, 5.0                    # [m] clay: |x|, y, depth
BED_X = (-13.5, 5.5)                                   # [m] the bed reaches a little beyond the water


class Mesh:
    """Nodes merged by body and place, elements and facets by set."""

    def __init__(self):
        self.x, self.index = [], {}
        self.hexahedra = {}     # set -> [8 nodes]
        self.facets = {}        # set -> [4 nodes]

    def node(self, body, x, y, z):
        key = (body, round(x * 1e7), round(y * 1e7), round(z * 1e7))
        if key not in self.index:
            self.index[key] = len(self.x)
            self.x.append((x, y, z))
        return self.index[key]

    def hexahedron(self, name, nodes):
        self.hexahedra.setdefault(name, []).append(nodes)

    def facet(self, name, nodes):
        self.facets.setdefault(name, []).append(nodes)


def perimeter(n, half):
    """n + 1 points of a half square's outline, from (half, 0) over the corners to (-half, 0)."""
    quarter = n // 4
    k = np.arange(n + 1)
    x = np.interp(k, [0, quarter, n - quarter, n], [half, half, -half, -half])
    y = np.interp(k, [0, quarter, n - quarter, n], [0, half, half, 0])
    return np.stack([x, y], axis=1)


def circle(n, radius):
    angle = np.pi * np.arange(n + 1) / n
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def core_point(u, v, half):
    """(u, v) in the half square [-1, 1] x [0, 1] -> plan, its outline bulged toward a circle."""
    s = max(abs(u), v)
    if s == 0:
        return np.zeros(2)
    angle = np.pi / 4 * v / u if abs(u) >= v and u > 0 else \
        np.pi - np.pi / 4 * v / -u if abs(u) >= v else np.pi / 2 - np.pi / 4 * u / v
    bulge = 0.55 * s
    return (1 - bulge) * half * np.array([u, v]) + bulge * 1.18 * half * s * np.array([np.cos(angle), np.sin(angle)])


def disc(n, radius, layers, half):
    """Quads (4 plan points each) of a half disc: a bulged half square and rings around it."""
    quarter = n // 4
    grid = {(i, j): core_point(i / quarter, j / quarter, half) for i in range(-quarter, quarter + 1) for j in range(quarter + 1)}
    quads = [[grid[i, j], grid[i + 1, j], grid[i + 1, j + 1], grid[i, j + 1]]
             for i in range(-quarter, quarter) for j in range(quarter)]
    inner = np.array([core_point(*p, half) for p in perimeter(n, 1.0)])
    return quads + rings(inner, circle(n, radius), np.linspace(0, 1, layers + 1))


def rings(inner, outer, share):
    """Quads between two outlines of n + 1 points; share: 0 ... 1 of the way."""
    quads = []
    for a, b in zip(share[:-1], share[1:]):
        low, high = inner + a * (outer - inner), inner + b * (outer - inner)
        quads += [[low[k], high[k], high[k + 1], low[k + 1]] for k in range(len(inner) - 1)]
    return quads


def graded(total, first, count):
    """0 ... 1 in `count` steps of which the first is first/total, growing geometrically."""
    low, high = 0.2, 5.0
    for _ in range(100):
        q = 0.5 * (low + high)
        length = first * sum(q ** k for k in range(count))
        low, high = (q, high) if length < total else (low, q)
    steps = first * q ** np.arange(count)
    return np.concatenate([[0], np.cumsum(steps)]) / steps.sum()


def plan_of_clay(n, width):
    """Plan quads of the clay, and its lines in y."""
    square_x = np.linspace(-SQUARE, SQUARE, n // 2 + 1)
    square_y = np.linspace(0, SQUARE, n // 4 + 1)
    outside = np.linspace(SQUARE, BOX_X, 6)[1:]     # 0.4 m: the slide presses on all of it
    lines_x = np.concatenate([-outside[::-1], square_x, outside])
    beyond = width + (BOX_Y - width) * graded(BOX_Y - width, 0.4, 3)[1:]
    lines_y = np.concatenate([square_y, np.linspace(SQUARE, width, max(2, round((width - SQUARE) / 0.25)) + 1)[1:], beyond])
    quads = disc(n, RADIUS - WALL - GAP, 2, 0.58)
    reach, layers = SQUARE - RADIUS, max(3, n // 4)
    quads += rings(circle(n, RADIUS + GAP), perimeter(n, SQUARE), graded(reach, 0.55 * reach / layers, layers))
    for xa, xb in zip(lines_x[:-1], lines_x[1:]):
        for ya, yb in zip(lines_y[:-1], lines_y[1:]):
            if max(abs(xa), abs(xb)) <= SQUARE + 1e-9 and yb <= SQUARE + 1e-9:
                continue
            quads.append([np.array(p) for p in ((xa, ya), (xb, ya), (xb, yb), (xa, yb))])
    return quads, lines_y


def in_slot(point, z):
    """Below the skirt's tip the two sides of the slot are one line."""
    r = np.hypot(*point)
    if z < -DEPTH and (abs(r - (RADIUS + GAP)) < 1e-6 or abs(r - (RADIUS - WALL - GAP)) < 1e-6):
        return point * (RADIUS - 0.5 * WALL) / r
    return point


def extrude(mesh, name, quads, levels):
    """Hexahedra between levels (rising z); facets on the outside of each set are added by the caller."""
    for low, high in zip(levels[:-1], levels[1:]):
        for quad in quads:
            nodes = [mesh.node(name, *in_slot(p, z), z) for z in (low, high) for p in quad]
            mesh.hexahedron(name, nodes)


def outer_faces(elements):
    """Faces that belong to one element only."""
    corner = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
    seen = {}
    for element in elements:
        for face in corner:
            nodes = [element[c] for c in face]
            key = tuple(sorted(nodes))
            seen[key] = None if key in seen else nodes
    return [nodes for nodes in seen.values() if nodes]


def build(n, layers, width):
    mesh = Mesh()
    buried = np.linspace(0, -DEPTH, layers + 1)
    below = -(DEPTH + GAP) - (BOX_Z - DEPTH - GAP) * graded(BOX_Z - DEPTH, DEPTH / layers, 7)
    clay_levels = np.concatenate([buried[:-1], below])[::-1]
    quads, lines_y = plan_of_clay(n, width)
    extrude(mesh, "clay", quads, clay_levels)

    above = np.linspace(0, HEIGHT - WALL, 4)
    skirt = rings(circle(n, RADIUS - WALL), circle(n, RADIUS), np.array([0.0, 1.0]))
    extrude(mesh, "bucket", skirt, np.concatenate([buried[::-1], above[1:], [HEIGHT]]))
    extrude(mesh, "bucket", disc(n, RADIUS - WALL, 2, 0.58), [HEIGHT - WALL, HEIGHT])

    x = np.array(mesh.x)
    r = np.hypot(x[:, 0], x[:, 1])
    near = 2e-3

    def on(nodes, distance):
        return np.all(np.abs(distance[nodes]) < near)

    for nodes in outer_faces(mesh.hexahedra["clay"]):
        center = x[nodes].mean(axis=0)
        if on(nodes, x[:, 1]):
            mesh.facet("symmetry", nodes)
        elif on(nodes, x[:, 2]):
            if center[1] < width and np.hypot(*center[:2]) > RADIUS:   # the plug inside is not coupled
                mesh.facet("mud_line", nodes)
        elif on(nodes, np.abs(x[:, 0]) - BOX_X) or on(nodes, x[:, 1] - BOX_Y) or on(nodes, x[:, 2] + BOX_Z):
            mesh.facet("far", nodes)
        else:
            mesh.facet("clay_skirt", nodes)
    for nodes in outer_faces(mesh.hexahedra["bucket"]):
        center = x[nodes].mean(axis=0)
        if on(nodes, x[:, 1]):
            continue
        outside, top = on(nodes, r - RADIUS), on(nodes, x[:, 2] - HEIGHT)
        if top or (outside and center[2] > 0):
            mesh.facet("bucket_wet", nodes)
        underside = on(nodes, x[:, 2] - (HEIGHT - WALL))
        if not top and not underside and center[2] < above[1]:
            mesh.facet("bucket_skirt", nodes)
    bed_lines = lines_y[lines_y <= width + 1e-9]
    for low, high, count in ((BED_X[0], -BOX_X, 12), (BOX_X, BED_X[1], 2)):
        lines = np.linspace(low, high, count + 1)
        for xa, xb in zip(lines[:-1], lines[1:]):
            for ya, yb in zip(bed_lines[:-1], bed_lines[1:]):
                # edge nodes at |x| = BOX_X are the clay's own: no leak where the two meet
                mesh.facet("bed", [mesh.node("clay", px, py, 0.0) for px, py in ((xa, ya), (xb, ya), (xb, yb), (xa, yb))])
    return mesh


def write(mesh, path):
    """Gmsh 4.1, ASCII: one entity per set."""
    x = np.array(mesh.x)
    low, high = x.min(axis=0), x.max(axis=0)
    volumes, surfaces = list(mesh.hexahedra), list(mesh.facets)
    out = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(volumes) + len(surfaces))]
    out += [f'2 {k + 1} "{name}"' for k, name in enumerate(surfaces)]
    out += [f'3 {k + 1} "{name}"' for k, name in enumerate(volumes)]
    out += ["$EndPhysicalNames", "$Entities", f"0 0 {len(surfaces)} {len(volumes)}"]
    box = " ".join(f"{v:.6g}" for v in (*low, *high))
    out += [f"{k + 1} {box} 1 {k + 1} 0" for k in range(len(surfaces))]
    out += [f"{k + 1} {box} 1 {k + 1} 0" for k in range(len(volumes))]
    out += ["$EndEntities", "$Nodes", f"1 {len(x)} 1 {len(x)}", f"3 1 0 {len(x)}"]
    out += [str(k + 1) for k in range(len(x))]
    out += [" ".join(f"{v:.9g}" for v in point) for point in x]
    out += ["$EndNodes", "$Elements"]
    blocks = [(2, 3, k, mesh.facets[name]) for k, name in enumerate(surfaces)]
    blocks += [(3, 5, k, mesh.hexahedra[name]) for k, name in enumerate(volumes)]
    total = sum(len(b[3]) for b in blocks)
    out.append(f"{len(blocks)} {total} 1 {total}")
    tag = 1
    for dimension, kind, k, elements in blocks:
        out.append(f"{dimension} {k + 1} {kind} {len(elements)}")
        for nodes in elements:
            out.append(" ".join(map(str, [tag, *(node + 1 for node in nodes)])))
            tag += 1
    out.append("$EndElements")
    with open(path, "w") as file:
        file.write("\n".join(out) + "\n")


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("file")
    arguments.add_argument("--angular", type=int, default=20, help="elements around half the bucket, a multiple of 4")
    arguments.add_argument("--depth-layers", type=int, default=12, help="elements along the buried skirt")
    arguments.add_argument("--width", type=float, default=2.5, help="[m] half width of the water, more than 2 and less than 4")
    chosen = arguments.parse_args()
    mesh = build(chosen.angular, chosen.depth_layers, chosen.width)
    write(mesh, chosen.file)
    print(f"{chosen.file}: {len(mesh.x)} nodes,", ", ".join(f"{len(v)} {k}" for k, v in {**mesh.hexahedra, **mesh.facets}.items()))


if __name__ == "__main__":
    main()
