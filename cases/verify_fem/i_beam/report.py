"""Deflection and twist of the end, against thin-walled beam theory."""
import numpy as np

from undertow_tool.verify.structure import MeasuredStructure

LENGTH, HEIGHT, WIDTH, LOADED = 2.0, 0.19, 0.1, 0.1      # [m] as in mesh.py


def deflection_of_timoshenko(force, web, flange, modulus, nu):
    """[m] of the end; force [N] spread over the last LOADED meters."""
    inertia = web * HEIGHT**3 / 12 + 2 * (WIDTH * flange * (HEIGHT / 2)**2 + WIDTH * flange**3 / 12)
    area = web * HEIGHT + 2 * WIDTH * flange
    m, n = 2 * WIDTH * flange / (HEIGHT * web), WIDTH / HEIGHT                  # Cowper's thin I-section
    kappa = 10 * (1 + nu) * (1 + 3 * m)**2 / (
        (12 + 72 * m + 150 * m**2 + 90 * m**3) + nu * (11 + 66 * m + 135 * m**2 + 90 * m**3)
        + 30 * n**2 * (m + m**2) + 5 * nu * n**2 * (8 * m + 9 * m**2))
    s = np.linspace(LENGTH - LOADED, LENGTH, 201)
    bending = np.mean(s**2 * (3 * LENGTH - s)) / (6 * modulus * inertia)
    shear = np.mean(s) / (kappa * modulus / (2 * (1 + nu)) * area)
    return force * (bending + shear)


def twist_of_thin_walls(torque, web, flange, modulus, nu, n=600):
    """[rad] of the end, of the line that joins the flanges. Vlasov's restrained torsion with what it leaves out: the
    flanges shear in their planes (bending b beside the twist's slope t'), and the web bends to an S when the flanges turn
    by p, less or more than the line between them turns by t,

        energy = integral of E I_w b'^2 / 2 + S (t' - b)^2 / 2 + 2 G J_f p'^2 / 2
                             + G J_w (t'^2 + (p' - t')^2 / 5) / 2 + k (p - t)^2 / 2,

    S = 2 (5/6) G A_f (height / 2)^2, k = 12 D / height with the web's bending stiffness D. The couple of two flange loads
    turns t, and only through the web the flanges' torsion; J_f is a rectangle's (its free edges take 0.63 flange / width
    off the thin strip's). n linear elements, one point; clamped at x = 0."""
    G = modulus / (2 * (1 + nu))
    warping = modulus * HEIGHT**2 / 4 * 2 * flange * WIDTH**3 / 12
    shear = 2 * 5 / 6 * G * WIDTH * flange * HEIGHT**2 / 4
    of_flanges, of_web = G * 2 * flange**3 * (WIDTH - 0.63 * flange) / 3, G * web**3 * HEIGHT / 3
    bending = 12 / HEIGHT * modulus * web**3 / (12 * (1 - nu**2))
    h = LENGTH / n
    values, rates = np.array([0.5, 0.5]), np.array([-1, 1]) / h

    def row(t, b, p):       # of the unknowns t, b, p at both nodes
        return np.array([t, b, p]).T.reshape(-1)

    none = np.zeros(2)
    element = h * sum(stiffness * np.outer(r, r) for stiffness, r in (
        (warping, row(none, rates, none)), (shear, row(rates, -values, none)), (of_flanges, row(none, none, rates)),
        (of_web, row(rates, none, none)), (of_web / 5, row(-rates, none, rates)), (bending, row(-values, none, values))))
    K, f = np.zeros((3 * (n + 1), 3 * (n + 1))), np.zeros(3 * (n + 1))
    for e in range(n):
        K[3 * e:3 * e + 6, 3 * e:3 * e + 6] += element
        if (e + 0.5) * h > LENGTH - LOADED:
            f[[3 * e, 3 * e + 3]] += 0.5 * h * torque / LOADED
    return float(np.linalg.solve(K[3:, 3:], f[3:])[-3])


def report(results_dir, case, summary):
    run = MeasuredStructure(results_dir, case, summary)
    fem = case["fem"]
    web, flange = fem["part"][0]["thickness"], fem["part"][1]["thickness"]
    modulus, nu = fem["material"][0]["young_modulus"], fem["material"][0]["poisson_ratio"]
    force = -fem["traction"][0]["value"][2] * HEIGHT * LOADED
    torque = fem["traction"][1]["value"][1] * WIDTH * LOADED * HEIGHT
    deflection = deflection_of_timoshenko(force, web, flange, modulus, nu)
    twist = twist_of_thin_walls(torque, web, flange, modulus, nu)
    run.compare("deflection", -run.mean_of_end("end.uz"), deflection, "m")
    measured = (run.mean_of_end("top.uy") - run.mean_of_end("bottom.uy")) / HEIGHT
    run.compare("twist", measured, twist, "rad")
    run.residual("still moving", max(run.unrest("end.uz"), run.unrest("top.uy")))
    return run.rows


def draw(axes, runs):
    """Deflection along the web's middle of the finest run."""
    run = runs[-1][1]
    x, u = run.fields.read(len(run.fields) - 1, "displacement")
    start = x - u
    at = (np.abs(start[:, 1]) < 1e-9) & (np.abs(start[:, 2]) < 1e-9)
    order = np.argsort(start[at, 0])
    axes.plot(start[at, 0][order], 1e6 * u[at, 2][order], color="#3b7dd8")
    axes.set(xlabel="x [m]", ylabel="deflection [1e-6 m]")
