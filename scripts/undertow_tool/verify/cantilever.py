"""The frequencies of a cantilever that a load has set swinging, against beam theory.

The report of every case of a straight beam along x, clamped at x = 0, with Poisson's ratio 0, that bends in z; a probe named
tip, rows of its history closer than a twentieth of the third period.
"""
import numpy as np

from .structure import MeasuredStructure

MODES = ("first", "second", "third")
KAPPA = 5 / 6       # of a rectangle at nu = 0 [Cowper, J. Appl. Mech. 33, 1966]


def beam_of(case):
    """(length, depth) [m] of the block, or of the sheet and its thickness."""
    fem = case["fem"]
    extent = np.subtract(fem["block"]["box"]["max"], fem["block"]["box"]["min"])
    return float(extent[0]), float(extent[2] or fem["part"][0]["thickness"])


def timoshenko(case, count):
    """The first frequencies [Hz]. Of the state s = (w, psi, M/b, V/b) of a section, s' = A s,
        w' = psi + V/(kappa G A),   psi' = M/(E I),   M' = -V - rho I omega^2 psi,   V' = -rho A omega^2 w
    from w = psi = 0 to M = V = 0: zeros of det of exp(A L)'s lower right quarter over omega."""
    length, depth = beam_of(case)
    material = case["fem"]["material"][0]
    modulus, density = material["young_modulus"], material["density"]
    shear, area, inertia = 0.5 * modulus, depth, depth**3 / 12        # nu = 0; per width

    def at_the_end(omega):
        rate = np.array([[0, 1, 0, 1 / (KAPPA * shear * area)], [0, 0, 1 / (modulus * inertia), 0],
                         [0, -density * inertia * omega**2, 0, -1], [-density * area * omega**2, 0, 0, 0]])
        scale = np.array([length, 1, modulus * inertia / length, modulus * inertia / length**2])
        values, vectors = np.linalg.eig(rate * length * scale[None, :] / scale[:, None])
        transfer = (vectors * np.exp(values)) @ np.linalg.inv(vectors)
        return float(np.linalg.det(transfer[2:, 2:]).real)

    slowest = np.sqrt(modulus / density) * depth / length**2
    grid = slowest * np.linspace(0.3, 60, 1200)
    signs = np.array([at_the_end(omega) for omega in grid])
    roots = []
    for k in np.flatnonzero(signs[1:] * signs[:-1] < 0)[:count]:
        low, high = grid[k], grid[k + 1]
        for _ in range(50):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if at_the_end(middle) * signs[k] > 0 else (low, middle)
        roots.append(0.5 * (low + high) / (2 * np.pi))
    return roots


def even(t, values, count):
    """values at `count` even times, by the cubic through four rows."""
    at = np.linspace(t[0], t[-1], count)
    first = np.clip(np.searchsorted(t, at) - 2, 0, len(t) - 4)
    rows = first[:, None] + np.arange(4)
    weight = np.ones((count, 4))
    for a in range(4):
        for b in range(4):
            if a != b:
                weight[:, a] *= (at - t[rows[:, b]]) / (t[rows[:, a]] - t[rows[:, b]])
    return at, np.sum(weight * values[rows], axis=1)


def frequencies(t, values, count, most=24):
    """The lowest frequencies [Hz] in a sum of undamped vibrations: the matrix pencil [Hua and Sarkar, IEEE Trans. ASSP 38,
    1990] with at most `most` exponentials."""
    at, y = even(t, values, 400)
    half = len(y) // 3
    hankel = np.array([y[k:k + half] for k in range(len(y) - half + 1)])
    _, sizes, across = np.linalg.svd(hankel, full_matrices=False)
    across = across[:min(most, int(np.sum(sizes > 1e-7 * sizes[0])))].conj().T
    poles = np.linalg.eigvals(np.linalg.pinv(across[:-1]) @ across[1:])
    amplitudes = np.linalg.lstsq(poles[None, :] ** np.arange(len(y))[:, None], y.astype(complex), rcond=None)[0]
    found = np.abs(np.angle(poles)) / (2 * np.pi * (at[1] - at[0]))
    sharp = (np.abs(np.abs(poles) - 1) < 1e-2) & (np.abs(amplitudes) > 1e-4 * np.abs(amplitudes).max()) & (found > 0)
    return np.unique(np.round(found[sharp], 9))[:count]


def report(results_dir, case, summary):
    run = MeasuredStructure(results_dir, case, summary)
    t, v = run.probe("tip.vz")
    swings = t > case["fem"]["traction"][0]["ramp"]
    found = frequencies(t[swings], v[swings], len(MODES))
    for name, ours, exact in zip(MODES, found, timoshenko(case, 3)):
        run.compare(f"{name} frequency", ours, exact, "Hz")
    return run.rows


def draw(axes, runs):
    """The tip's velocity."""
    for label, run in runs:
        t, v = run.probe("tip.vz")
        axes.plot(1e3 * t, 1e3 * v, linewidth=0.8, label=label)
    axes.set(xlabel="t [ms]", ylabel="velocity of the tip [mm/s]")
    axes.legend(fontsize=7)
