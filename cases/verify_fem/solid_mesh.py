"""Writes meshes of hexahedra: what the mesh.py of the cases beside it share."""
import numpy as np
from shell_mesh import ShellMesh


class SolidMesh(ShellMesh):
    """Hexahedra by set as well; nodes at one place are one node, so bodies that touch stand a gap apart."""

    def block(self, name, points):
        """points (n + 1, m + 1, k + 1, 3), right-handed: n x m x k hexahedra. Returns the nodes' numbers (n + 1, m + 1, k + 1)."""
        nodes = np.array([[[self.node(p) for p in row] for row in layer] for layer in points])
        near, far = nodes[:, :, :-1], nodes[:, :, 1:]
        corners = np.stack([at for side in (near, far) for at in
                            (side[:-1, :-1], side[1:, :-1], side[1:, 1:], side[:-1, 1:])], axis=-1)
        self.hexahedra.setdefault(name, []).extend(corners.reshape(-1, 8).tolist())
        return nodes

    def box(self, name, low, high, divisions):
        """A box of equal cells."""
        x, y, z = (np.linspace(a, b, n + 1) for a, b, n in zip(low, high, divisions))
        return self.block(name, np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1))

    def face(self, name, nodes):
        """A facet set of the nodes (n + 1, m + 1) of one side of a block; the solver turns normals outward."""
        corners = np.stack([nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]], axis=-1)
        self.quads.setdefault(name, []).extend(corners.reshape(-1, 4).tolist())
