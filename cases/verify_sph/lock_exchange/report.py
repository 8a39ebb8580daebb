"""Lock exchange: speeds of both fronts, depth of the light current, and the budgets."""
import numpy as np

from undertow_tool.verify.measured import Measured

LIGHT, DENSE = 0, 1                     # indices of sph.fluid
SPAN = (1.4, 3.3)                       # of t sqrt((1 - g) G/H), over which speeds are fitted: after the start
TIP = 0.005                             # [H^2] volume per width that lies ahead of what counts as the front


def setup(run):
    """(density ratio light/dense, depth H [m], gate [m], unit of speed sqrt((1 - g) G H) [m/s])"""
    light, dense = (fluid["density"] for fluid in run.case["sph"]["fluid"])
    box = run.case["sph"]["fill"][DENSE]["box"]
    depth = box["max"][2] - box["min"][2]
    return light / dense, depth, box["max"][0], np.sqrt((1 - light / dense) * -run.gravity[2] * depth)


def benjamin(a):
    """Speed of a current that takes the share a of the depth, over sqrt(g' H), g' that of the fluid ahead
    [Benjamin 1968]."""
    return np.sqrt(a * (1 - a) * (2 - a) / (1 + a))


def dense_front(ratio):
    """(depth over H, speed in the unit of speed) of the dense front: the state behind the light front, half the depth and
    speed 1/2, followed along the backward characteristic of the two-layer equations until it meets the front
    condition. With U of the dense layer, u = -U a/(1 - a) of the light one (no net flux),
        a_t + (a U)_x = 0,   U_t + U U_x - ratio (u_t + u u_x) = -a_x
    """
    a, U, da = 0.5, 0.5, 2e-5

    def slope(a, U):
        u, u_a, u_U = -U * a / (1 - a), -U / (1 - a) ** 2, -a / (1 - a)
        mass = 1 - ratio * u_U
        own = (U - ratio * (u * u_U - u_a * a)) / mass
        push = (1 - ratio * (u * u_a - u_a * U)) / mass
        backward = 0.5 * (U + own) - np.sqrt(0.25 * (U - own) ** 2 + a * push)
        return (backward - U) / a

    while benjamin(a) / np.sqrt(ratio) > U:
        U -= da * slope(a - 0.5 * da, U - 0.5 * da * slope(a, U))
        a -= da
    return a, U


def fronts(run, step, depth):
    """(dense, light) [m]: where TIP H^2 of the fluid lie ahead."""
    x, = run.fields.read(step)
    fluid, count = run.fluid_of(step, len(x)), max(1, round(TIP * depth**2 / run.dx**2))
    return np.sort(x[fluid == DENSE, 0])[-count], np.sort(x[fluid == LIGHT, 0])[count - 1]


def light_depth(run, step, light, depth):
    """Depth of the light current between one and two thirds of the way from its front to the gate, over H."""
    gate = setup(run)[2]
    low, high = light + (gate - light) / 3, light + 2 * (gate - light) / 3
    x, density = run.fields.read(step, "density")
    volume = run.masses(step, len(x)) / density / run.case["case"]["thickness"]
    inside = (run.fluid_of(step, len(x)) == LIGHT) & (x[:, 0] > low) & (x[:, 0] < high)
    return float(volume[inside].sum()) / (high - low) / depth


def report(results_dir, case, summary):
    run = Measured(results_dir, case, summary)
    ratio, depth, _, unit = setup(run)
    time = run.times * unit / depth
    chosen = np.flatnonzero((time >= SPAN[0]) & (time <= SPAN[1]))
    found = np.array([fronts(run, step, depth) for step in chosen])
    dense, light = np.polyfit(run.times[chosen], found, 1)[0]
    run.compare("speed of the dense front", dense, dense_front(ratio)[1] * unit, "m/s")
    run.compare("speed of the light front", -light, 0.5 * unit, "m/s")
    run.compare("depth of the light current over H", light_depth(run, chosen[-1], found[-1, 1], depth), 0.5)
    run.residual("momentum, not accounted for", run.momentum_error())
    energy = run.history("energy.sph")
    total = energy["kinetic"] + energy["potential"] + energy["elastic"]
    released = energy["potential"][0] - energy["potential"].min()
    run.residual("energy, largest rise over what gravity released", np.max(total - np.minimum.accumulate(total)) / released)
    run.tell("energy dissipated over what gravity released", float((total[0] - total[-1]) / released))
    return run.rows


def draw(axes, runs):
    label, run = runs[-1]
    ratio, depth, gate, unit = setup(run)
    dense = dense_front(ratio)[1]
    length = run.case["sph"]["fill"][LIGHT]["box"]["max"][0]
    for k, t in enumerate((0.6, 1.1, 1.6)):
        step, low = run.fields.nearest(t), -1.4 * depth * k
        x, = run.fields.read(step)
        mine = run.fluid_of(step, len(x)) == DENSE
        axes.plot(x[mine, 0], x[mine, 2] + low, ".", color="#b5793a", markersize=0.7)
        axes.plot([0, length, length, 0, 0], np.array([0, 0, depth, depth, 0]) + low, color="#888888", linewidth=0.7)
        for speed, z in ((dense, 0.0), (-0.5, depth)):
            axes.plot(gate + speed * unit * run.times[step], z + low, "k|", markersize=9)
        axes.text(0.05, low + 1.07 * depth, f"{t:g} s, {label}; bars: theory", fontsize=6)
    axes.set(aspect="equal", xlabel="x [m]", yticks=[])
    axes.grid(False)
