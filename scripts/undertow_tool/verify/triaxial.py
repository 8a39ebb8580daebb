"""Axial stress and dilation of a cube of sand that flows in a triaxial cell, against the Mohr-Coulomb pyramid and its
flow: the report of sand_compression and sand_extension."""
import numpy as np

from .structure import MeasuredStructure


def exact(sand, cell, compression):
    """(axial stress [Pa], tension positive; volume over axial strain) where f = 0 and two principal stresses are -cell."""
    sin_phi, cos_phi = np.sin(np.radians(sand["friction_angle"])), np.cos(np.radians(sand["friction_angle"]))
    sin_psi = np.sin(np.radians(sand["dilation_angle"]))
    c = sand["cohesion"]
    if compression:     # the axial stress is the smallest
        return (-(1 + sin_phi) * cell - 2 * c * cos_phi) / (1 - sin_phi), -2 * sin_psi / (1 - sin_psi)
    return (-(1 - sin_phi) * cell + 2 * c * cos_phi) / (1 + sin_phi), 2 * sin_psi / (1 + sin_psi)


def course(run):
    """(lengths [m] (n, 3), axial stress [Pa]) over time."""
    u = np.stack([run.history(f"fem.history.{axis}")[f"u{axis}"] for axis in "xyz"], axis=1)
    lengths = 1 + u
    force = run.history("fem.history")["motion piston.fz"]
    return lengths, force[-len(lengths):] / (lengths[:, 0] * lengths[:, 1])


def report(results_dir, case, summary):
    run = MeasuredStructure(results_dir, case, summary)
    lengths, stress = course(run)
    compression = case["fem"]["motion"][0]["velocity"][2] < 0
    strength, dilation = exact(case["fem"]["material"][0], case["fem"]["pressure"][0]["value"], compression)
    run.compare("axial stress", float(np.mean(stress[-20:])), strength, "Pa")
    strains = np.log(lengths[-1] / lengths[len(lengths) // 2])
    run.compare("volume over axial strain", float(strains.sum() / strains[2]), dilation)
    return run.rows


def draw(axes, runs):
    """Axial stress and volume of all runs over the axial strain."""
    other = axes.twinx()
    for name, run in runs:
        lengths, stress = course(run)
        strain = np.abs(np.log(lengths[:, 2]))
        axes.plot(100 * strain, 1e-3 * np.abs(stress), label=name)
        other.plot(100 * strain, 100 * np.log(lengths.prod(axis=1)), linestyle=":")
    axes.set(xlabel="axial strain, size [%]", ylabel="axial stress, size [kPa]")
    other.set_ylabel("volume strain [%] (dotted)")
    axes.legend(fontsize=7)
