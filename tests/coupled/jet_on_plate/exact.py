"""A plane jet of width b and speed U, normal to an infinite plate, by its hodograph.

With s = (u - i w)/U the jet fills the upper half of the unit disc, the plate its diameter. The jet
comes from s = i with the flux b U and leaves at s = 1 and -1 with half of it each:
    W = (b U/pi) log((s^2 + 1)/(s^2 - 1)),  dz = dW/(U s),
    x + i z = (b/pi) [2 atan s + log((1 + s)/(1 - s))]
On the plate s = u/U is real and p = (1 - s^2) rho U^2/2, whose integral is rho U^2 b.
"""
import numpy as np


def place(s, width):
    """x + i z [m] where the velocity is s."""
    return width / np.pi * (2 * np.arctan(s) + np.log((1 + s) / (1 - s)))


def velocity(x, z, width):
    """s at points [m], by Newton's method; |s| = 1 outside of the jet."""
    at = np.asarray(x) + 1j * np.asarray(z)
    s = np.tanh(np.pi * at.real / (4 * width)) * 0.9 + 0.1j * np.minimum(at.imag / width, 5)
    for _ in range(60):  # steps no longer than 0.1, all of them inside of the disc
        step = (place(s, width) - at) * (1 - s**4) * np.pi / (4 * width)
        size = np.abs(step)
        s = s - step * np.minimum(1, 0.1 / np.maximum(size, 1e-30))
        s = s * np.minimum(1, 0.9999 / np.maximum(np.abs(s), 1e-30))
        s = s.real + 1j * np.maximum(s.imag, 0)
    return s


def pressure(x, z, width, speed, density):
    """[Pa]"""
    return 0.5 * density * speed**2 * (1 - np.abs(velocity(x, z, width)) ** 2)
