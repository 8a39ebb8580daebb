"""Water at rest on an elastic floor: pressure, gap, force and momentum. Means over the second half."""
import csv
import json

import h5py
import numpy as np

DX, DEPTH, RHO, G = 0.01, 0.2, 1000, 9.81
WEIGHT = RHO * G * 0.08 * 0.08 * DEPTH
PER_LAYER, LAYERS = 64, 20


def history(path):
    rows = [row for row in csv.reader(open(path)) if row and not row[0].startswith("#")]
    return dict(zip(rows[0], np.array(rows[1:], float).T))


def layers(results):
    """Time means per layer, height [m] and pressure [Pa]; mean height of the four lowest particles in
    the middle [m]; gain of upward momentum [N s]; largest speed at the end [m/s]."""
    with h5py.File(results / "sph.vtkhdf") as file:
        data = file["VTKHDF"]
        t, offset = data["Steps/Values"][:], data["Steps/PointOffsets"][:]
        late = [k for k in range(len(t)) if t[k] > 0.5 * t[-1]]
        z = p = middle = 0
        momentum = []
        for k in late:
            rows = slice(offset[k], offset[k] + PER_LAYER * LAYERS)
            x = data["Points"][rows]
            order = np.argsort(x[:, 2])
            lowest = x[order[:PER_LAYER]]
            near = np.argsort(np.hypot(lowest[:, 0] - 0.04, lowest[:, 1] - 0.04))[:4]
            middle += lowest[near, 2].mean() / len(late)
            momentum.append(RHO * DX ** 3 * data["PointData/velocity"][rows][:, 2].sum())
            z = z + x[order, 2].reshape(LAYERS, PER_LAYER).mean(1) / len(late)
            p = p + data["PointData/pressure"][rows][order].reshape(LAYERS, PER_LAYER).mean(1) / len(late)
        speed = np.linalg.norm(data["PointData/velocity"][rows], axis=1).max()
    return z, p, middle, t[late[0]], momentum[-1] - momentum[0], speed


def check(results):
    z, p, middle, since, gained, speed = layers(results)
    exact = RHO * G * (z[-1] + DX / 2 - z)
    # The lattice's own gradient error is 1 % at h = 1.2 dx; at 1.5 dx it is 0.3 %.
    for k in range(1, LAYERS):
        scale = exact[k] if k < LAYERS - 4 else RHO * G * DEPTH
        assert abs(p[k] - exact[k]) < 0.02 * scale, f"layer {k}: {p[k]:.1f} Pa, exact {exact[k]:.1f} Pa"
    gaps = np.diff(z)
    assert np.all(abs(gaps / DX - 1) < 0.01), f"layers stand {gaps / DX} spacings apart"

    # The first layer is pressed into the surface by p dx^2/k, k = rho c0^2 dx.
    c0 = json.loads((results / "summary.sph.json").read_text())["sph"]["sound_speed"]
    sunk = RHO * G * DEPTH / (RHO * c0 ** 2) * DX
    fem = history(results / "fem.history.csv")
    late = fem["t [s]"] >= since
    center = fem["center.uz [m]"][late].mean()
    gap, designed = middle - center, DX / 2 - sunk
    assert abs(gap - designed) < 0.1 * DX / 2, f"gap to the plate {gap} m, designed {designed} m"

    forces = history(results / "forces.csv")
    t, impulse = forces["t [s]"], forces["plate.jz [N s]"]
    first = np.searchsorted(t, since * (1 - 1e-9))
    mean = (impulse[-1] - impulse[first]) / (t[-1] - t[first])
    assert abs(mean + WEIGHT) < 0.01 * WEIGHT, f"mean contact force {mean:.3f} N, weight {WEIGHT:.3f} N"
    # Newton: what the force exceeds the weight by is the water's momentum. Impulses stand at t + dt/2,
    # velocities at t - dt/2: one step of 2000.
    missing = -mean - WEIGHT - gained / (t[-1] - t[first])
    assert abs(missing) < 2e-3 * WEIGHT, f"{missing:.4f} N between contact force, weight and momentum"

    # Started on an unbent plate, the water bounces once; a source of energy would keep it moving.
    assert speed < 2e-3 * c0, f"particles still move with {speed:.4f} m/s"
    coupler = json.loads((results / "summary.coupler.json").read_text())
    assert coupler["momentum_residual"] == 0
