#!/usr/bin/python3
"""An elastic block by GetFEM, a finite element library that knows nothing of Undertow, in place of
fem_solver. GetFEM assembles stiffness and mass once; time is ours. Needs the Debian packages
python3-getfem and python3-scipy. Reads [backend.getfem_wall]:

    [backend.getfem_wall]
    box = [1.61, 0, 0, 1.63, 0.15, 0.6]   # [m] xmin ymin zmin xmax ymax zmax
    divisions = [1, 6, 24]       # hexahedra with 27 nodes; two facets per element and direction
    wet = "xmin"                 # the face that the fluid touches
    held = ["ymin", "ymax", "zmin"]       # faces that do not move
    density = 1190               # [kg/m3]
    young_modulus = 3.2e9        # [Pa]
    poisson_ratio = 0.32
    damping = 0                  # [1/s] mass-proportional
    largest_step = 0             # [s] 0: a tenth of 1/omega of the lowest mode
    probe = [1.61, 0.075, 0.3]   # [m] whose displacement is recorded; default: middle of the wet face
    surface = "wall"             # name of the coupled surface

Equations: small strain, isotropic Hooke; M row-sum lumped (positive for these elements, by the weights
of Simpson). Time: leapfrog with the inertia M + h^2/4 K, h a little above the largest step offered: one
factorization serves every dt <= h, no mode is unstable, and a mode slows by 1/sqrt(1 + (omega h)^2/4).
"""
import sys

import numpy as np
from backend import Energies, main, stable_factor

try:
    import getfem
    import scipy.sparse as sparse
    from scipy.sparse.linalg import eigsh, splu
except ImportError as missing:
    sys.exit(f"getfem_wall: {missing}; install the Debian packages python3-getfem and python3-scipy")

FACES = {name: (axis, side) for axis, letter in enumerate("xyz")
         for side, name in enumerate((letter + "min", letter + "max"))}


def sparse_of(matrix):
    """A GetFEM matrix as SciPy's."""
    columns, rows = matrix.csc_ind()
    return sparse.csc_matrix((matrix.csc_val(), rows, columns), shape=tuple(matrix.size()))


class GetfemWall:
    limiter = "lowest mode of the block"
    changing = "omega", "u", "v", "last_dt", "books", "shown", "peak", "force_max"
    columns = "probe displacement x [m]", "probe displacement y [m]", "probe displacement z [m]", "force [N]"

    def __init__(self, table):
        box = table.numbers("box", 6)
        divisions = table.counts("divisions", 3)
        wet = table.word("wet", None, tuple(FACES))
        held = table.take("held", None, "a list of faces")
        if not isinstance(held, list) or not held or any(face not in FACES for face in held) or wet in held:
            table.refuse("held", held, "some of " + ", ".join(FACES) + ", and not the wet one")
        density, young = (table.number(key, above=0) for key in ("density", "young_modulus"))
        nu = table.number("poisson_ratio", least=0)
        if nu >= 0.5:
            table.refuse("poisson_ratio", nu, "< 0.5")
        self.damping = table.number("damping", 0.0, least=0)
        self.largest_step = table.number("largest_step", 0.0, least=0)
        self.surface = table.word("surface", "wall")
        if not (box[3:] > box[:3]).all():
            table.refuse("box", box.tolist(), "six numbers with max > min")

        lines = [np.linspace(box[axis], box[axis + 3], divisions[axis] + 1) for axis in range(3)]
        mesh = getfem.Mesh("cartesian", *lines)
        fem, scalar = getfem.MeshFem(mesh, 3), getfem.MeshFem(mesh, 1)
        fem.set_classical_fem(2)
        scalar.set_classical_fem(0)
        integral = getfem.MeshIm(mesh, 6)
        one = np.ones(scalar.nbdof())
        self.stiffness = sparse_of(getfem.asm_linear_elasticity(
            integral, fem, scalar, one * young * nu / ((1 + nu) * (1 - 2 * nu)), one * young / (2 * (1 + nu))))
        self.mass = density * np.asarray(sparse_of(getfem.asm_mass_matrix(integral, fem)).sum(axis=1)).ravel()
        nodes = fem.basic_dof_nodes().T     # (dof, 3), three dofs in a row at each node
        on_face = {name: np.isclose(nodes[:, axis], box[axis + 3 * side], atol=1e-9 * np.ptp(box))
                   for name, (axis, side) in FACES.items()}
        self.free = np.flatnonzero(~np.logical_or.reduce([on_face[name] for name in held]))
        self._lay_surface(nodes, on_face[wet], wet)

        k, m = self.stiffness[self.free][:, self.free], self.mass[self.free]
        # v0: left out it is drawn by chance, and with it the last bits of the step
        self.omega = float(np.sqrt(eigsh(k, 1, sparse.diags(m), sigma=0, v0=np.ones(len(m)),
                                         return_eigenvectors=False)[0]))
        self.k_free = k.tocsr()
        self.u, self.v = np.zeros(len(self.free)), np.zeros(len(self.free))     # [m] at t, [m/s] at t - dt/2
        self.last_dt, self.books = 0.0, Energies()
        probe = table.numbers("probe", 3, list(self.x0.mean(axis=0)))
        self.probe = int(np.linalg.norm(self.x0 - probe, axis=1).argmin())
        self.shown, self.peak, self.force_max = np.zeros(4), 0.0, 0.0
        self.inertia = self.solve = None
        self.description = (f"GetFEM, {mesh.nbcvs()} hexahedra of 27 nodes, {len(self.free)} unknowns, "
                            f"lowest mode {self.omega / 2 / np.pi:.4g} Hz")

    def _lay_surface(self, nodes, wet, face):
        """Nodes of the wet face in rows, its facets, and the dofs of each node."""
        axis, side = FACES[face]
        a, b = [other for other in range(3) if other != axis]
        first = np.flatnonzero(wet)[::3]                        # x dof of each node
        order = np.lexsort((nodes[first, b].round(9), nodes[first, a].round(9)))
        first = first[order]
        self.dofs = first[:, None] + np.arange(3)
        self.x0 = nodes[first]
        n_b = len(np.unique(self.x0[:, b].round(9)))
        corner = (np.arange(len(first) // n_b - 1)[:, None] * n_b + np.arange(n_b - 1)).ravel()
        self.quad = np.stack([corner, corner + n_b, corner + n_b + 1, corner + 1], axis=1)
        outward = np.zeros(3)
        outward[axis] = 2 * side - 1
        edges = self.x0[self.quad[0]]
        if np.cross(edges[1] - edges[0], edges[3] - edges[0]) @ outward < 0:
            self.quad = self.quad[:, ::-1].copy()
        self.nodal_mass = self.mass[first]

    def stable_step(self, contact_share):
        offered = self.largest_step or 0.1 / self.omega
        h = offered / stable_factor(contact_share)
        self.inertia = sparse.diags(self.mass[self.free]) + 0.25 * h * h * self.k_free
        self.solve = splu(self.inertia.tocsc()).solve
        return offered

    def full(self, values):
        everywhere = np.zeros(len(self.mass))
        everywhere[self.free] = values
        return everywhere[self.dofs]

    def step(self, f, dt):
        load = np.zeros(len(self.mass))
        load[self.dofs] = f
        load = load[self.free]
        total = float(np.linalg.norm(f.sum(axis=0)))
        self.shown = np.append(self.full(self.u)[self.probe], total)
        self.peak = max(self.peak, float(np.linalg.norm(self.shown[:3])))
        self.force_max = max(self.force_max, total)

        kick = 0.5 * (self.last_dt + dt)
        inner = self.k_free @ self.u
        drag = 0.5 * kick * self.damping
        before = self.v
        self.v = ((1 - drag) * before + kick * self.solve(load - inner)) / (1 + drag)
        lost = self.damping * (self.inertia @ (0.5 * (before + self.v)))
        self.books.book(before, self.v, 0.0, 0.5 * float(self.u @ inner), load, lost, self.last_dt)
        self.books.kinetic = 0.5 * float(before @ (self.inertia @ self.v))
        self.u = self.u + dt * self.v
        self.last_dt = dt
        if not np.isfinite(self.u).all():
            raise ArithmeticError(f"the block's displacement is no number after a force of {total} N")

    def positions(self):
        return self.x0 + self.full(self.u)

    def velocities(self):
        return self.full(self.v)

    def energies(self):
        return self.books.row()

    def motion(self):
        return self.shown

    def summary(self):
        return {"first_frequency": self.omega / 2 / np.pi, "unknowns": len(self.free),
                "probe_displacement_max": self.peak, "force_max": self.force_max}


if __name__ == "__main__":
    sys.exit(main("getfem_wall", "getfem_wall 0.1.0", "An elastic block by GetFEM", GetfemWall))
