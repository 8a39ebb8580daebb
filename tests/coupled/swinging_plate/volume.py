"""How high the water of a run stands over the plate it bends, from its field files and histories.

    volume.py RESULTS           a line for each twentieth of the run
"""
import csv
import pathlib
import sys

import h5py
import numpy as np

# of the deflection 16 s^2 (1 - s)^2 of a clamped strip under an even load, over the wet part of the span
MEAN_OVER_MIDDLE = 0.6335


def history(path):
    rows = [row for row in csv.reader(open(path)) if row and not row[0].startswith("#")]
    return dict(zip(rows[0], np.array(rows[1:], float).T))


def heights(results):
    """t [s], mean height of the particles over the mean of the plate [m], deflection of its middle [m]."""
    fem = history(results / "fem.history.csv")
    with h5py.File(results / "sph.vtkhdf") as file:
        root = file["VTKHDF"]
        t, first = root["Steps/Values"][:], root["Steps/PointOffsets"][:]
        n = np.resize(root["NumberOfPoints"][:], len(t))
        z = np.array([root["Points"][a:a + b, 2].mean() for a, b in zip(first, n)])
    bend = np.interp(t, fem["t [s]"], fem["center.uz [m]"])
    return t, z - MEAN_OVER_MIDDLE * bend, bend


def main():
    t, height, bend = heights(pathlib.Path(sys.argv[1]))
    for part in np.array_split(np.arange(len(t)), 20):
        print(f"{t[part[0]]:8.2f} s: mean height {1e3 * height[part].mean():7.3f} mm,"
              f" plate {1e3 * bend[part].mean():7.3f} +- {1e3 * bend[part].std():6.3f} mm")


if __name__ == "__main__":
    main()
