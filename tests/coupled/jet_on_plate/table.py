#!/usr/bin/python3
"""table.py RESULTS: force, pressure and the first layers along the plate, and what it cost."""
import csv
import json
import pathlib
import sys

import h5py
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import exact  # noqa: E402

WIDTH, SPEED, DENSITY, THICKNESS = 0.2, 2.0, 1000.0, 0.05
STAGNATION = 0.5 * DENSITY * SPEED**2  # [Pa]
FORCE = DENSITY * SPEED**2 * WIDTH / 2 * THICKNESS  # [N] of half the jet
BINS = np.linspace(0, 1.5 * WIDTH, 16)  # [m] along the plate


def force(results):
    """Of the plate's contact, downward, over the second half of the run [N]."""
    rows = [row for row in csv.reader(open(results / "forces.csv")) if row and row[0][0] != "#"]
    history = dict(zip(rows[0], np.array(rows[1:], float).T))
    t, impulse = history["t [s]"], history["plate.jz [N s]"]
    half = np.searchsorted(t, 0.5 * t[-1])
    return -(impulse[-1] - impulse[half]) / (t[-1] - t[half])


def late_particles(results):
    """Particles of all outputs of the second half: x [m], height [m], pressure [Pa]; outputs."""
    with h5py.File(results / "sph.vtkhdf") as file:
        data = file["VTKHDF"]
        t, offset = data["Steps/Values"][:], data["Steps/PointOffsets"][:]
        points, p = data["Points"][:], data["PointData/pressure"][:]
        end = np.append(offset[1:], len(p))
        late = np.flatnonzero(t > 0.5 * t[-1])
        rows = np.concatenate([np.arange(offset[k], end[k]) for k in late])
    return points[rows, 0], points[rows, 2], p[rows], len(late)


def layers(results, dx, most=3):
    """Of each slab of one spacing along the plate: number of particles over that of a lattice, their
    mean height [dx], and mean and rms error of the pressure over the bins [of the stagnation pressure]."""
    x, z, p, outputs = late_particles(results)
    found = []
    for k in range(most):
        inside = (x < BINS[-1]) & (z >= k * dx) & (z < (k + 1) * dx)
        error = p[inside] - exact.pressure(x[inside], z[inside], WIDTH, SPEED, DENSITY)
        bin_of = np.digitize(x[inside], BINS) - 1
        means = np.array([error[bin_of == b].mean() for b in range(len(BINS) - 1)]) / STAGNATION
        found.append((inside.sum() / outputs / (BINS[-1] / dx), z[inside].mean() / dx, means.mean(),
                      np.sqrt((means**2).mean()), error.std() / STAGNATION))
    return found


def stagnation(results, dx):
    """Mean of p over its exact value there, in the first two layers within 0.1 widths."""
    x, z, p, _ = late_particles(results)
    near = (x < 0.1 * WIDTH) & (z < 2 * dx)
    return p[near].mean() / exact.pressure(x[near], z[near], WIDTH, SPEED, DENSITY).mean()


def main():
    results = pathlib.Path(sys.argv[1])
    dx = json.loads((results / "case.json").read_text())["sph"]["spacing"]
    cost = json.loads((results / "summary.sph.json").read_text())
    found = force(results)
    print(f"dx = width/{WIDTH / dx:.0f}")
    print(f"force {found:.3f} N, exact {FORCE:.3f} N: {found / FORCE - 1:+.2%}")
    print(f"stagnation pressure: {stagnation(results, dx) - 1:+.2%}")
    print("layer  particles  height   pressure: mean    rms     scatter, of rho U^2/2")
    for k, (count, height, mean, rms, scatter) in enumerate(layers(results, dx)):
        print(f"{k + 1:5d}  {count:9.3f}  {height:6.3f}   {mean:+14.2%}  {rms:6.2%}  {scatter:6.2%}")
    print(f"{cost['steps']} steps, {cost['sph']['particle_steps']:.3g} particle-steps, "
          f"{cost['sph']['particle_steps_per_busy_s']:.3g} of them a second")


if __name__ == "__main__":
    main()
