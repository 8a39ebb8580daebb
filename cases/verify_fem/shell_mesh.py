"""Writes meshes of shells: what the mesh.py of the cases beside it share."""
import numpy as np


class ShellMesh:
    """Quads by set, edges by set; nodes at one place are one node."""

    def __init__(self):
        self.x, self.index = [], {}
        self.quads, self.edges, self.points, self.hexahedra = {}, {}, {}, {}

    def node(self, point):
        key = tuple(round(1e7 * c) for c in point)
        if key not in self.index:
            self.index[key] = len(self.x)
            self.x.append(tuple(point))
        return self.index[key]

    def sheet(self, name, points):
        """points (n + 1, m + 1, 3): n x m quads, their normals along (first direction) x (second). Returns
        the nodes' numbers (n + 1, m + 1)."""
        nodes = np.array([[self.node(p) for p in row] for row in points])
        corners = np.stack([nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]], axis=-1)
        self.quads.setdefault(name, []).extend(corners.reshape(-1, 4).tolist())
        return nodes

    def line(self, name, nodes):
        """A set of nodes along a line of edges."""
        self.edges.setdefault(name, []).extend(zip(nodes[:-1], nodes[1:]))

    def point(self, name, node):
        """A set of one node."""
        self.points[name] = [(node,)]

    def write(self, path):
        """Gmsh 4.1, ASCII: one entity per set. A quad of several sets stands in the file once for each."""
        x = np.array(self.x)
        sets = [(0, 15, name, cells) for name, cells in self.points.items()]
        sets += [(1, 1, name, cells) for name, cells in self.edges.items()]
        sets += [(2, 3, name, cells) for name, cells in self.quads.items()]
        sets += [(3, 5, name, cells) for name, cells in self.hexahedra.items()]
        out = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(sets))]
        out += [f'{dimension} {k + 1} "{name}"' for k, (dimension, _, name, _) in enumerate(sets)]
        out += ["$EndPhysicalNames", "$Entities", f"{len(self.points)} {len(self.edges)} {len(self.quads)} {len(self.hexahedra)}"]
        box = " ".join(f"{v:.6g}" for v in (*x.min(axis=0), *x.max(axis=0)))
        for k, (dimension, _, _, cells) in enumerate(sets):
            at = " ".join(f"{v:.6g}" for v in x[cells[0][0]]) if dimension == 0 else box
            out.append(f"{k + 1} {at} 1 {k + 1}" + (" 0" if dimension else ""))
        out += ["$EndEntities", "$Nodes", f"1 {len(x)} 1 {len(x)}", f"2 {len(self.points) + len(self.edges) + 1} 0 {len(x)}"]
        out += [str(k + 1) for k in range(len(x))]
        out += [" ".join(f"{v:.12g}" for v in point) for point in x]
        total = sum(len(cells) for *_, cells in sets)
        out += ["$EndNodes", "$Elements", f"{len(sets)} {total} 1 {total}"]
        tag = 0
        for k, (dimension, kind, _, cells) in enumerate(sets):
            out.append(f"{dimension} {k + 1} {kind} {len(cells)}")
            for cell in cells:
                tag += 1
                out.append(" ".join(map(str, (tag, *(node + 1 for node in cell)))))
        out.append("$EndElements")
        with open(path, "w") as file:
            file.write("\n".join(out) + "\n")
