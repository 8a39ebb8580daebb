"""Standing wave: frequency and decay from the history of the kinetic energy."""
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


def exact(run):
    omega = np.sqrt(-run.gravity[2] * WAVE_NUMBER * np.tanh(WAVE_NUMBER * DEPTH))
    fluid = run.case["sph"]["fluid"][0]
    return omega, 4 * fluid["viscosity"] / fluid["density"] * WAVE_NUMBER**2


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
