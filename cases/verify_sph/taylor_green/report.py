"""Taylor-Green vortex: rate of decay, and the velocity field against the exact one."""
import numpy as np

from undertow_tool.verify.measured import Measured

K = np.pi                               # [1/m]
SPAN = (0.2, 2.0)                       # [s] of the fit


def exact_rate(run):
    """Of velocities [1/s]."""
    fluid = run.case["sph"]["fluid"][0]
    return 2 * fluid["viscosity"] / fluid["density"] * K**2


def exact_velocity(x, decay):
    """(n, 2): u and w."""
    return decay * np.column_stack([np.sin(K * x[:, 0]) * np.cos(K * x[:, 2]), -np.cos(K * x[:, 0]) * np.sin(K * x[:, 2])])


def report(results_dir, case, summary):
    run = Measured(results_dir, case, summary)
    energy = run.history("energy.sph")
    span = (energy["t"] >= SPAN[0]) & (energy["t"] <= SPAN[1])
    rate = -0.5 * np.polyfit(energy["t"][span], np.log(energy["kinetic"][span]), 1)[0]
    run.compare("rate of decay", rate, exact_rate(run), "1/s")
    errors = []
    for t in (0.5, 1.0, 2.0):
        x, v = run.at(t, "velocity")
        time = run.times[run.fields.nearest(t)]
        wanted = exact_velocity(x, np.exp(-exact_rate(run) * time))
        errors.append(np.sqrt(np.mean(np.sum((v[:, [0, 2]] - wanted) ** 2, axis=1)) / np.mean(np.sum(wanted**2, axis=1))))
    for t, error in zip((0.5, 1.0, 2.0), errors):
        run.residual(f"velocity field at {t:g} s, rms over rms", error)
    last = len(run.fields) - 1
    x, density = run.fields.read(last, "density")
    volume = float(np.sum(run.masses(last, len(x)) / density)) / case["case"]["thickness"]
    start = float(np.sum(run.masses(0, len(x)) / run.fields.read(0, "density")[1])) / case["case"]["thickness"]
    run.residual("volume of all particles, change", volume / start - 1)
    return run.rows


def draw(axes, runs):
    for label, run in runs:
        energy = run.history("energy.sph")
        axes.semilogy(energy["t"], energy["kinetic"] / energy["kinetic"][0], linewidth=0.9, label=label)
    axes.semilogy(energy["t"], np.exp(-2 * exact_rate(run) * energy["t"]), "k--", linewidth=0.7, label="exact")
    axes.set(xlabel="t [s]", ylabel="kinetic energy/start")
    axes.legend()
