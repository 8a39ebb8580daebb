"""Exact limit load of a strip footing on clay whose strength grows with depth, by the method of characteristics.

    /usr/bin/python3 scripts/undertow_tool/verify/slip_lines.py      table of smooth and rough footings, as Davis and
                                                                     Booker (1973, Geotechnique 23, 551) have it

Weightless Tresca soil in plane strain, s(z) = s_0 + k z, z downward, footing -B < x < 0, free surface x > 0, compression
positive, p the mean stress, theta the angle of the major principal stress from the vertical:

    sigma_z = p + s cos 2 theta      sigma_x = p - s cos 2 theta      tau_xz = s sin 2 theta
    along dx/dz = tan(theta + pi/4)     dp + 2 s dtheta + k dx = 0      (alpha: from the free surface toward the footing)
    along dx/dz = tan(theta - pi/4)     dp - 2 s dtheta - k dx = 0      (beta: out of the edge)

Free surface: theta = pi/2, p = s_0. At the edge a fan turns theta from there to where the footing begins, p = s_0 +
2 s_0 (pi/2 - theta). Smooth: theta = 0 on the footing, whose pressure is p + s_0; each half mirrors the other. Rough: a wedge
of soil moves with the footing; its side is the beta line that meets the axis of symmetry at 45 degrees (theta = 0), and the
load is that on its sides. It starts at the edge, at an angle that k B/s_0 decides, up to the flattest: theta = -pi/4. Beyond,
the soil slips along the outer footing as well, theta = -pi/4 there, and the wedge begins farther in.
"""
from math import cos, pi, sin, tan

import numpy as np

QUARTER = 0.25 * pi
PRANDTL = 2 + pi


class SlipLines:
    """Alpha lines from the free surface, one after the other. Stresses are over s_0, `gradient` is k over s_0 [1/m]. The lines
    end on the footing, whose theta is `fan_end`, or, `meets_footing` false, on the last beta line of the fan."""

    def __init__(self, gradient, fan_end, meets_footing, steps):
        self.k, self.end, self.meets_footing = gradient, fan_end, meets_footing
        # points of a line: x, z, p, theta; the first line is the edge itself
        self.lines = [[(0.0, 0.0, 1 + 2 * (0.5 * pi - t), t) for t in np.linspace(0.5 * pi, fan_end, steps + 1)]]

    def _meet(self, on_alpha, on_beta):
        """Where the alpha line through one point meets the beta line through the other: means over the step, by iteration."""
        xa, za, pa, ta = on_alpha
        xb, zb, pb, tb = on_beta
        k, t, mean_a, mean_b = self.k, tb, ta, tb
        for _ in range(5):
            a, b = mean_a + QUARTER, mean_b - QUARTER
            u = ((xb - xa) * cos(b) - (zb - za) * sin(b)) / (sin(a) * cos(b) - cos(a) * sin(b))
            x, z = xa + u * sin(a), za + u * cos(a)
            two_s = 2 + k * z
            ma, mb = two_s + k * za, two_s + k * zb       # twice the mean strengths
            right_a, right_b = pa + ma * ta - k * (x - xa), pb - mb * tb + k * (x - xb)
            t = (right_a - right_b) / (ma + mb)
            mean_a, mean_b = 0.5 * (ta + t), 0.5 * (tb + t)
        return x, z, right_a - ma * t, t

    def _on_footing(self, on_alpha):
        xa, za, pa, ta = on_alpha
        x = xa - za * tan(0.5 * (ta + self.end) + QUARTER)
        return x, 0.0, pa - (2 + self.k * za) * (self.end - ta) - self.k * (x - xa), self.end

    def next_line(self, x):
        """The alpha line from the free surface at x; its last point."""
        line = [(x, 0.0, 1.0, 0.5 * pi)]
        for on_beta in self.lines[-1]:
            line.append(self._meet(line[-1], on_beta))
        if self.meets_footing:
            line.append(self._on_footing(line[-1]))
        self.lines.append(line)
        return line[-1]

    def beta_line(self, i, j):
        """The beta line through point j of line i, from there on."""
        return np.array([line[j + n] for n, line in enumerate(self.lines[i:])])


def places(gradient, size, steps):
    """On the free surface, the first `steps` of them up to `size`: close together where the strength grows by much of itself."""
    n = 0
    while True:
        n += 1
        yield size * n / steps if gradient == 0 else np.expm1(np.log1p(gradient * size) * n / steps) / gradient


def smooth_load(ratio, steps):
    """Mean pressure over s_0 under a smooth footing, ratio = k B/s_0."""
    half = 1.0
    field = SlipLines(ratio / 2, 0.0, True, steps)
    x, q = [0.0], [PRANDTL]
    reach = places(ratio / 2, half, steps)
    while x[-1] < half:
        point = field.next_line(next(reach))
        x.append(-point[0])
        q.append(point[2] + 1)
    x, q = np.array(x), np.array(q)
    at_axis = np.interp(half, x, q)
    x[-1], q[-1] = half, at_axis
    return float(np.trapz(q, x))


def vertical_force(points, gradient):
    """Of the soil on what lies above and to the left of a line of points that goes to the left, upward, over s_0."""
    x, z, p, theta = points.T
    s = 1 + gradient * z
    return np.trapz(s * np.sin(2 * theta), z) - np.trapz(p + s * np.cos(2 * theta), x)


def to_axis(side):
    """The part of a wedge's side up to where theta = 0; None when it does not come that far."""
    past = np.flatnonzero(side[:, 3] >= 0)
    if len(past) == 0 or past[0] == 0:
        return None
    n = past[0]
    share = -side[n - 1, 3] / (side[n, 3] - side[n - 1, 3])
    return np.vstack([side[:n], side[n - 1] + share * (side[n] - side[n - 1])])


def wedge_from_edge(fan_end, steps):
    """(k B/s_0, mean pressure over s_0) of the rough footing whose wedge begins at the edge at the angle fan_end. k/s_0 = 1."""
    field = SlipLines(1.0, fan_end, False, steps)
    reach = places(1.0, max(-2 * fan_end, 0.02), steps)
    while field.lines[-1][-1][3] < 0:
        field.next_line(next(reach))
    side = to_axis(field.beta_line(0, steps))
    return -2 * side[-1, 0], vertical_force(side, 1.0) / -side[-1, 0]


def wedges_from_footing(ratio, steps):
    """The same of wedges that begin on the footing, up to at least the wanted one."""
    field, found = SlipLines(1.0, -QUARTER, True, steps), [wedge_from_edge(-QUARTER, steps)]
    first, reach = 0, places(1.0, max(1.0, 0.3 * ratio), steps)
    while found[-1][0] < ratio:
        field.next_line(next(reach))
        while first + 2 < len(field.lines):
            side = to_axis(field.beta_line(first + 1, len(field.lines[first + 1]) - 1))
            if side is None:
                break
            first += 1
            under = np.array([line[-1] for line in field.lines[:first + 1]])
            load = vertical_force(under, 1.0) + vertical_force(side, 1.0)
            found.append((-2 * side[-1, 0], load / -side[-1, 0]))
    return found


def rough_load(ratio, steps):
    """Mean pressure over s_0 under a rough footing, ratio = k B/s_0."""
    if ratio == 0:
        return PRANDTL      # the side is straight: theta = 0 all along
    if ratio > wedge_from_edge(-QUARTER, steps)[0]:
        return float(np.interp(ratio, *zip(*wedges_from_footing(ratio, steps))))
    low, high = -QUARTER, 0.0
    for _ in range(30):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if wedge_from_edge(middle, steps)[0] > ratio else (low, middle)
    return wedge_from_edge(0.5 * (low + high), steps)[1]


def converged(load, ratio, steps=20):
    """(value, doubt): second order in the length of a step."""
    coarse, fine = load(ratio, steps), load(ratio, 2 * steps)
    return fine + (fine - coarse) / 3, abs(fine - coarse) / 3


if __name__ == "__main__":
    print("k B/s_0    smooth: q/s_0       F        rough: q/s_0       F        F = q/((2 + pi) s_0 + k B/4)")
    for ratio in (0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 20.0, 100.0):
        row = f"{ratio:7.1f}"
        for load in (smooth_load, rough_load):
            q, doubt = converged(load, ratio)
            row += f"    {q:9.5f} +- {doubt:.5f}  {q / (PRANDTL + ratio / 4):.4f}"
        print(row, flush=True)
