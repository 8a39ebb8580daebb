"""Cook's membrane: deflection of the free end, what still moves, and whether the pressure alternates.

The report of every case of the panel with corners (0, 0), (48, 44), (48, 60), (0, 44) in x and z, n x 1 x n cells, and
the references of its Poisson's ratio in [report.reference], for a force of 1 over modulus and thickness.
"""
import numpy as np

from .structure import MeasuredStructure

EXTENT = 16.0          # [m] of the loaded edge


def pressure_of_cells(run):
    """(n, n) mean pressure of each cell of the block at the end [Pa]; a cell may be six tetrahedra."""
    n = run.case["fem"]["block"]["divisions"]
    pressure = run.fields.read(len(run.fields) - 1, "pressure")[1]
    return pressure.reshape(n[2], n[0], -1).mean(axis=2)


def saw_tooth(pressure):
    """What alternates from cell to cell in both directions, rms over rms: small like h^2 in a smooth field. Without
    the quarter next to the clamp, in whose upper corner the exact pressure has no bound."""
    pressure = pressure[:, pressure.shape[1] // 4:]
    alternating = 0.25 * (pressure[1:, 1:] - pressure[:-1, 1:] - pressure[1:, :-1] + pressure[:-1, :-1])
    return float(np.sqrt(np.mean(alternating**2) / np.mean(pressure**2)))


def report(results_dir, case, summary):
    run = MeasuredStructure(results_dir, case, summary)
    material, reference = case["fem"]["material"][0], case["report"]["reference"]
    force = case["fem"]["traction"][0]["value"][2] * EXTENT * case["case"]["thickness"]
    scale = force / (material["young_modulus"] * case["case"]["thickness"])
    for place in ("corner", "middle"):
        run.compare(f"deflection of the {place}", run.mean_of_end(f"{place}.uz"), reference[place] * scale, "m")
    run.residual("still moving", run.unrest("corner.uz"))
    run.residual("saw-tooth of the pressure", saw_tooth(pressure_of_cells(run)))
    return run.rows


def draw(axes, runs):
    """The deformed panel, magnified, of the finest run."""
    run = runs[-1][1]
    x, u = run.fields.read(len(run.fields) - 1, "displacement")
    n = run.case["fem"]["block"]["divisions"]
    shape = (n[2] + 1, n[1] + 1, n[0] + 1, 3)
    start, moved = (x - u).reshape(shape)[:, 0], u.reshape(shape)[:, 0]
    deformed = start + 8 / np.abs(u).max() * moved
    for nodes, style in ((start, {"color": "#bbbbbb", "linewidth": 0.4}), (deformed, {"color": "#3b7dd8", "linewidth": 0.6})):
        for line in (*nodes, *nodes.transpose(1, 0, 2)):
            axes.plot(line[:, 0], line[:, 2], **style)
    axes.set(xlabel="x [m]", ylabel="z [m]", aspect="equal")
