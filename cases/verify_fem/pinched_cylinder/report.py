"""Compliance under the force, against a double Fourier series, and what still moves."""
import numpy as np

from undertow_tool.verify.structure import MeasuredStructure

RADIUS, LENGTH = 300.0, 600.0      # [m] as in mesh.py


def compliance(modulus, nu, thickness, terms=400):
    """[m/N] of a point of a pair of opposite radial forces at midspan. Koiter's shell with the curvatures of Sanders; with
    diaphragms every (u, v, w) = (U cos a x cos n th, V sin a x sin n th, W sin a x cos n th), a = m pi/L, is on its own:

        e_x = u,x   e_t = (v,t + w)/R   g = v,x + u,t/R
        k_x = -w,xx   k_t = (v,t - w,tt)/R^2   2 k_xt = -2 w,xt/R + (3/2) v,x/R - u,t/(2 R^2)

    [Sanders, NASA TR R-24, 1959]. Without transverse shear, whose share has no bound under a point but is small here."""
    C, D = modulus * thickness / (1 - nu**2), modulus * thickness**3 / (12 * (1 - nu**2))
    m, n = np.meshgrid(np.arange(1, 2 * terms, 2.0), np.arange(0, 2 * terms, 2.0), indexing="ij")
    a, zero, R = m * np.pi / LENGTH, 0 * m, RADIUS
    e_x, e_t, g = (np.stack(row, -1) for row in ((-a, zero, zero), (zero, n / R, zero + 1 / R), (-n / R, a, zero)))
    k_x, k_t, k_xt = (np.stack(row, -1) for row in (
        (zero, zero, a**2), (zero, n / R**2, n**2 / R**2), (n / (2 * R**2), 1.5 * a / R, 2 * a * n / R)))

    def product(p, q):
        return p[..., :, None] * q[..., None, :]

    K = sum(stiffness * (product(x, x) + product(y, y) + nu * (product(x, y) + product(y, x)) + (1 - nu) / 2 * product(xy, xy))
            for stiffness, x, y, xy in ((C, e_x, e_t, g), (D, k_x, k_t, k_xt)))
    K *= (LENGTH / 2 * R * np.pi * np.where(n == 0, 2, 1))[..., None, None]
    force = np.zeros((*m.shape, 3, 1))
    force[..., 2, 0] = 2 * np.sin(m * np.pi / 2)
    return float(np.sum(np.linalg.solve(K, force)[..., 2, 0] * np.sin(m * np.pi / 2)))


def report(results_dir, case, summary):
    run = MeasuredStructure(results_dir, case, summary)
    material = case["fem"]["material"][0]
    exact = compliance(material["young_modulus"], material["poisson_ratio"], case["fem"]["part"][0]["thickness"])
    # two planes of symmetry go through the force
    ours = run.mean_of_end("motion load.uz") / (4 * run.mean_of_end("motion load.fz"))
    run.compare("compliance under the force", ours, exact, "m/N")
    run.residual("still moving", run.unrest("motion load.fz"))
    return run.rows


def draw(axes, runs):
    """Midspan of the finest run, magnified."""
    run = runs[-1][1]
    x, u = run.fields.read(len(run.fields) - 1, "displacement")
    start = x - u
    at = np.abs(start[:, 0] - LENGTH / 2) < 1e-3
    order = np.argsort(start[at, 1])
    scale = 60 / np.abs(u).max()
    axes.plot(start[at, 1][order], start[at, 2][order], color="#bbbbbb", linewidth=1, label="before")
    moved = (start + scale * u)[at][order]
    axes.plot(moved[:, 1], moved[:, 2], color="#3b7dd8", label=f"midspan, displacement x {scale:.2g}")
    axes.set(xlabel="y [m]", ylabel="z [m]", aspect="equal")
    axes.legend(fontsize=7)
