"""Velocities of the exact solution of an elastic collision, the impulse, and the books."""
import csv
import json
import re


def last(results, name):
    text = (results / name).read_text()
    return [float(x) for x in re.search(r"final z = (\S+) v = (\S+)", text).groups()]


def check(results):
    m, M, v0 = 2.0, 3.0, -1.5
    _, v = last(results, "particles.log")
    _, V = last(results, "surface.log")
    v_exact, V_exact = (m - M) / (m + M) * v0, 2 * m / (m + M) * v0
    # (omega dt)^2 = k dt^2/m_eff = 3e-4 with dt = 2e-5: the entry phase scatters e by well below 1 %.
    assert abs(v - v_exact) < 0.01 * abs(v0), f"ball leaves with {v} m/s, exact {v_exact}"
    assert abs(V - V_exact) < 0.01 * abs(v0), f"plate leaves with {V} m/s, exact {V_exact}"
    assert abs(m * v + M * V - m * v0) < 1e-9, "momentum is not conserved"

    rows = [row for row in csv.reader(open(results / "forces.csv")) if not row[0].startswith("#")]
    impulse = float(rows[-1][rows[0].index("plate.jz [N s]")])
    assert abs(impulse - M * V) < 1e-8 * abs(M * V), f"impulse {impulse} N s, the plate got {M * V}"

    summary = json.loads((results / "summary.coupler.json").read_text())
    assert summary["momentum_residual"] == 0
    assert summary["interface_work_residual"] < 1e-9, summary["interface_work_residual"]
    # The spring is found compressed at its first step and left stretched at its last: booked.
    assert abs(summary["interface_numerical_loss"]) < 1e-4, summary["interface_numerical_loss"]
    assert summary["late_searches"] == 0
    # Half a period: pi sqrt(m_eff/k) = 3.44 ms.
    assert abs(summary["contact_s"] - 3.44e-3) < 4e-5, summary["contact_s"]
