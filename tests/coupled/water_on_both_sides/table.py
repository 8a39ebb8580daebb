#!/usr/bin/python3
"""table.py RESULTS: pressure of every layer over and under the plate, and what the plate carries."""
import csv
import json
import pathlib
import sys

import h5py
import numpy as np

RHO_G, PLATE, SURFACE, AREA, PER_LAYER = 9810, -0.001, 0.1, 0.0064, 64


def layers(path):
    """Means over the second half of the run: height [m] and pressure [Pa] of each layer."""
    with h5py.File(path) as file:
        data = file["VTKHDF"]
        t, offset = data["Steps/Values"][:], data["Steps/PointOffsets"][:]
        n = offset[1] - offset[0]
        z, p, late = 0, 0, np.flatnonzero(t > 0.5 * t[-1])
        for k in late:
            rows = slice(offset[k], offset[k] + n)
            height = data["Points"][rows][:, 2]
            order = np.argsort(height)
            z = z + height[order].reshape(-1, PER_LAYER).mean(1) / len(late)
            p = p + data["PointData/pressure"][rows][order].reshape(-1, PER_LAYER).mean(1) / len(late)
    return z, p


def mean_force(results, face):
    """Upward, over the second half of the run [N]."""
    rows = [row for row in csv.reader(open(results / "forces.csv")) if row and row[0][0] != "#"]
    history = dict(zip(rows[0], np.array(rows[1:], float).T))
    t, impulse = history["t [s]"], history[face + ".jz [N s]"]
    half = np.searchsorted(t, 0.5 * t[-1])
    return (impulse[-1] - impulse[half]) / (t[-1] - t[half])


def main():
    results = pathlib.Path(sys.argv[1])
    for z, p in zip(*layers(results / "sph.vtkhdf")):
        exact = RHO_G * ((PLATE if z < 0 else SURFACE) - z)
        print(f"z {z:8.4f} m   p {p:7.1f} Pa   exact {exact:7.1f} Pa")
    for face, exact in (("plate", -RHO_G * AREA * SURFACE), ("under", 0.0)):
        print(f"{face}: {mean_force(results, face):.3f} N, exact {exact:.3f} N")
    cost = json.loads((results / "summary.sph.json").read_text())
    print(f"{cost['steps']} steps, {cost['sph']['particle_steps_per_busy_s']:.3g} particle-steps/s")


if __name__ == "__main__":
    main()
