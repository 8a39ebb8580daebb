"""Standing wave: frequency and decay from the history of the kinetic energy, against the exact linear wave of the fluid that
is solved, viscous and weakly compressible."""
import numpy as np

from undertow_tool.verify.measured import Measured

WAVE_NUMBER, DEPTH = 2 * np.pi, 0.5     # [1/m], [m]
DELAY = 0.4                             # [s] for the sound of the start to fade


def fit(t, kinetic, near):
    """omega [rad/s] and rate of decay of the energy [1/s] of E_k = exp(-r t) (a + b cos 2 w t + c sin 2 w t).

    a is free: the decaying wave at rest has no kinetic energy, but noise has.
    """
    def rest(omega, rate):
        fade = np.exp(-rate * t)
        columns = np.column_stack([fade, fade * np.cos(2 * omega * t), fade * np.sin(2 * omega * t)])
        found = np.linalg.lstsq(columns, kinetic, rcond=None)[0]
        return float(np.sum((columns @ found - kinetic) ** 2))

    omega, rate, width, spread = near, 0.5, 0.3, 1.0
    for _ in range(14):
        omegas = np.linspace(omega * (1 - width), omega * (1 + width), 11)
        rates = np.linspace(rate - spread, rate + spread, 11)
        errors = np.array([[rest(o, r) for r in rates] for o in omegas])
        i, j = np.unravel_index(np.argmin(errors), errors.shape)
        omega, rate = omegas[i], rates[j]
        width, spread = width / 2.5, spread / 2.5
    return omega, rate


def chebyshev(degree):
    """Points from 1 to -1 and the matrix that differentiates there [Trefethen, Spectral methods in Matlab, 2000]."""
    x = np.cos(np.pi * np.arange(degree + 1) / degree)
    c = np.r_[2, np.ones(degree - 1), 2] * (-1.0) ** np.arange(degree + 1)
    apart = x[:, None] - x[None, :]
    D = np.outer(c, 1 / c) / (apart + np.eye(degree + 1))
    return x, D - np.diag(D.sum(axis=1))


def linear_wave(g, k, depth, nu, c0, degree=32):
    """omega [rad/s] and rate of decay of the energy [1/s] of u = U(z) sin(kx), w = W(z) cos(kx), p = rho P(z) cos(kx),
    surface E cos(kx), all times exp(lambda t), on a free-slip floor:
        lambda U = k P + nu (U'' - k^2 U)            lambda P = g W - c0^2 (k U + W')
        lambda W = -P' - g P/c0^2 + nu (W'' - k^2 W)  lambda E = W at the surface,
    where P = g E + 2 nu W' and U' = k W. To leading order lambda = i sqrt(g k tanh(k H)) - 2 nu k^2; the boundary layer
    below the surface takes (nu k^2/omega)^(3/2) from both  [Lamb 1932, art. 349], 7.6 % of the decay here.
    """
    x, D = chebyshev(degree)
    n, D = degree + 1, D * 2 / depth
    one, U, W, P = np.eye(n), slice(0, n), slice(n, 2 * n), slice(2 * n, 3 * n)
    L, M = np.zeros((3 * n + 1, 3 * n + 1)), np.eye(3 * n + 1)
    L[U, U] = L[W, W] = nu * (D @ D - k * k * one)
    L[U, P], L[W, P] = k * one, -D - g / c0**2 * one
    L[P, U], L[P, W] = -c0**2 * k * one, g * one - c0**2 * D
    L[3 * n, n] = 1
    edges = [n, 2 * n - 1] if nu == 0 else [0, n, n - 1, 2 * n - 1]  # rows of U, W at the surface and at the floor
    for row in edges:
        L[row] = M[row] = 0
    L[n, 2 * n], L[n, 3 * n], L[n, W] = 1, -g, -2 * nu * D[0]
    L[2 * n - 1, 2 * n - 1] = 1
    if nu > 0:
        L[0, U], L[0, n], L[n - 1, U] = D[0], -k, D[-1]
    leading = 1j * np.sqrt(g * k * np.tanh(k * depth)) - 2 * nu * k * k
    of = np.linalg.eigvals(np.linalg.solve(L - leading * M, M))  # 1/(lambda - leading): the nearest is the largest
    nearest = leading + 1 / of[np.argmax(np.abs(of))]
    return nearest.imag, -2 * nearest.real


def exact(run):
    fluid = run.case["sph"]["fluid"][0]
    nu = fluid.get("viscosity", 0) / fluid["density"]
    omega, rate = linear_wave(-run.gravity[2], WAVE_NUMBER, DEPTH, nu, run.sph["sound_speed"])
    return omega, rate if nu > 0 else 0.0


def report(results_dir, case, summary):
    run = Measured(results_dir, case, summary)
    energy = run.history("energy.sph")
    later = energy["t"] > DELAY
    omega_exact, rate_exact = exact(run)
    omega, rate = fit(energy["t"][later], energy["kinetic"][later], omega_exact)
    run.compare("frequency", omega, omega_exact, "rad/s")
    if rate_exact > 0:
        run.compare("decay of the energy", rate, rate_exact, "1/s")
    else:
        run.residual("decay of the energy of an inviscid wave", rate / omega_exact)
    return run.rows


def draw(axes, runs):
    for label, run in runs:
        energy = run.history("energy.sph")
        axes.plot(energy["t"], energy["kinetic"] / energy["kinetic"][0], linewidth=0.9, label=label)
    omega, rate = exact(run)
    t = np.linspace(0, energy["t"][-1], 400)
    axes.plot(t, np.exp(-rate * t) * np.cos(omega * t) ** 2, "k--", linewidth=0.7, label="linear theory")
    axes.set(xlabel="t [s]", ylabel="kinetic energy/start")
    axes.legend()
