"""Forces, contact times and rebound of the bars, against waves in one dimension."""
import numpy as np

from undertow_tool.verify.structure import MeasuredStructure

LENGTH, SIDE, APART, GAP = 1.0, 0.02, 0.04, 1e-4      # [m] as in mesh.py


def theory(case):
    """(wave speed [m/s], speed of the wall [m/s], force of contact [N]): rho c v A, while the wave is under way."""
    material = case["fem"]["material"][0]
    c = float(np.sqrt(material["young_modulus"] / material["density"]))
    v = case["fem"]["motion"][0]["velocity"][0]
    return c, v, material["density"] * c * v * SIDE**2


def closed(t, force, half):
    """(first time, last time) [s] at which the force passes half of its plateau."""
    over = force > half
    first, last = int(np.argmax(over)), len(over) - 1 - int(np.argmax(over[::-1]))

    def passed(k):
        return float(t[k] + (half - force[k]) / (force[k + 1] - force[k]) * (t[k + 1] - t[k]))

    return passed(first - 1), passed(last)


def speed_of(run, second_bar):
    """[m/s] of a bar's center of mass at the end: its nodes stand for equal cells, those at its ends for half of one."""
    step = len(run.fields) - 1
    x, u, v = run.fields.read(step, "displacement", "velocity")
    x = x - u
    own = (x[:, 0] > -0.5 * GAP) & ((x[:, 1] > 0.5 * APART) == second_bar)
    ends = [0, LENGTH] + ([LENGTH / 2, LENGTH / 2 + GAP] if second_bar else [])
    if second_bar:
        ends[1] += GAP
    weight = np.where(np.min(np.abs(x[own, :1] - ends), axis=1) < 0.1 * GAP, 0.5, 1.0)
    return float(np.sum(weight * v[own, 0]) / np.sum(weight))


def report(results_dir, case, summary):
    run = MeasuredStructure(results_dir, case, summary)
    c, v, force = theory(case)
    travel = LENGTH / c
    for name, of, begins, ends in (("bar", "one piece", 0.0, 2.0), ("lower", "two pieces", 0.0, 2.0), ("joint", "the joint", 0.5, 1.5)):
        t, found = run.probe(f"{name}.normal")
        middle = (t > (begins + 0.2) * travel) & (t < (ends - 0.2) * travel)
        run.compare(f"force plateau, {of}", np.mean(found[middle]), force, "N")
        first, last = closed(t, found, 0.5 * force)
        run.compare(f"contact time, {of}", last - first, (ends - begins) * travel, "s")
    for second_bar, of in ((False, "one piece"), (True, "two pieces")):
        run.compare(f"restitution, {of}", speed_of(run, second_bar) / v - 1, 1.0)
    return run.rows


def draw(axes, runs):
    """Forces of the finest run."""
    run = runs[-1][1]
    for name in ("bar", "lower", "joint"):
        t, force = run.probe(f"{name}.normal")
        axes.plot(1e3 * t, force / 1e3, linewidth=0.8, label=name)
    axes.axhline(theory(run.case)[2] / 1e3, color="k", linestyle="--", linewidth=0.8)
    axes.set(xlabel="t [ms]", ylabel="force [kN]")
    axes.legend(fontsize=7)
