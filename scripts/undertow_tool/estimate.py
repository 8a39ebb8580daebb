"""What a case will cost, without running it: particles, elements, memory, steps, wall time."""
import math
from pathlib import Path

import numpy as np

# Measured on two Zen 4 cores, whole runs; other machines differ, so the result is an estimate. Dam break coupled, one pass a step:
# 9.7 M particle-steps/s of both; against a rigid wall, two passes: 3.5 M; the slide on the bucket, two passes, 1.35 dx: 3.7 M.
PARTICLE_STEPS_PER_S = 4.9e6          # per core, one pass a step, 58 neighbors
TWO_PASS_STEPS_PER_S = 1.8e6          # the same of two passes
ELEMENT_STEPS_PER_S = 20e6            # per core, one-point hexahedra in double
BBAR_STEPS_PER_S = 8e6                # the same of 8-point hexahedra
SECONDS_PER_COUPLED_STEP = 150e-6     # messages and contact that computing does not hide
PARTICLE_BYTES = 600                  # state in double, packed copies, neighbor list, share of walls
ELEMENT_BYTES = 600                   # node and element state, connectivity
SPH_STEP_MARGIN = 0.75                # a run's mean step over the estimate: impacts shorten it
ONE_PASS, TWO_PASS = 0.25, 0.9        # c0 dt/dx of the two integrators, with their margins


def particle_rate(case, dt):
    """Particle-steps/s of a core at steps of dt: one pass where steps are short (solver.cpp, takes_two_passes); more neighbors cost more."""
    sph = case["sph"]
    c0, speed = sound_speed(case), expected_speed(case)
    passes = {"one_pass": 1, "two_pass": 2}.get(sph["integrator"], 1 if dt <= 0.5 * ONE_PASS * sph["spacing"] / (c0 + speed) else 2)
    support = 2 * sph["smoothing_ratio"]
    neighbors = math.pi * support**2 if case["case"]["dimension"] == 2 else 4 / 3 * math.pi * support**3
    cost = max(1.0, neighbors / 58) ** 0.5
    return (PARTICLE_STEPS_PER_S if passes == 1 else TWO_PASS_STEPS_PER_S) / cost


def boxes_of(case):
    return [fill["box"] for fill in case["sph"]["fill"]]


def particles(case):
    """Number of particles of all fills, cell-centered; what fills share counts once (their boxes'
    overlaps, pair by pair)."""
    dx = case["sph"]["spacing"]
    axes = (0, 2) if case["case"]["dimension"] == 2 else (0, 1, 2)

    def cells(low, high):
        return math.prod(max(0, round((high[k] - low[k]) / dx)) for k in axes)

    boxes = boxes_of(case)
    count = sum(cells(box["min"], box["max"]) for box in boxes)
    for index, one in enumerate(boxes):
        for other in boxes[index + 1:]:
            count -= cells([max(p) for p in zip(one["min"], other["min"])],
                           [min(p) for p in zip(one["max"], other["max"])])
    return count


def expected_speed(case):
    """sph.max_speed, or 2 sqrt(g H) + |v| of the fills."""
    if case["sph"]["max_speed"] > 0:
        return case["sph"]["max_speed"]
    height = max(b["max"][2] for b in boxes_of(case)) - min(b["min"][2] for b in boxes_of(case))
    start = max(math.hypot(*fill["velocity"]) for fill in case["sph"]["fill"])
    return 2 * math.sqrt(abs(case["case"]["gravity"][2]) * height) + start


def sound_speed(case):
    return max(10 * expected_speed(case) if f["sound_speed"] == "auto" else f["sound_speed"] for f in case["sph"]["fluid"])


def sph_step(case):
    """(dt [s], what limits it): sound."""
    sph, speed, c0 = case["sph"], expected_speed(case), sound_speed(case)
    h = sph["smoothing_ratio"] * sph["spacing"]
    if sph["cfl"] > 0:
        dt = sph["cfl"] * h / (c0 + speed)
    else:
        courant = ONE_PASS if sph["integrator"] == "one_pass" else TWO_PASS
        dt = courant * sph["spacing"] / (c0 + speed)
    return dt, f"sound, c0 = {c0:.4g} m/s"


def read_hexahedra(path, rigid):
    """(edge lengths' minimum [m], number of hexahedra) of an ASCII Gmsh 4.1 file, or None. Volume
    sets named in `rigid` limit no step and are left out."""
    try:
        lines = iter(path.read_text().splitlines())
        nodes, shortest, count = {}, math.inf, 0
        names, entities = {}, {}          # of volumes: physical tag -> name, entity -> physical tags
        for line in lines:
            if line == "$PhysicalNames":
                for _ in range(int(next(lines))):
                    dimension, tag, name = next(lines).split(maxsplit=2)
                    if dimension == "3":
                        names[int(tag)] = name.strip('"')
            elif line == "$Entities":
                counts = [int(n) for n in next(lines).split()]
                for dimension, n in enumerate(counts):
                    for _ in range(n):
                        words = next(lines).split()
                        at = 4 if dimension == 0 else 7
                        if dimension == 3:
                            entities[int(words[0])] = [int(w) for w in words[at + 1:at + 1 + int(words[at])]]
            elif line == "$Nodes":
                for _ in range(int(next(lines).split()[0])):
                    n = int(next(lines).split()[3])
                    tags = [int(next(lines)) for _ in range(n)]
                    nodes.update((tag, np.array(next(lines).split()[:3], dtype=float)) for tag in tags)
            elif line == "$Elements":
                for _ in range(int(next(lines).split()[0])):
                    _, entity, kind, n = map(int, next(lines).split())
                    rows = [next(lines).split() for _ in range(n)]
                    if kind != 5 or any(names.get(tag) in rigid for tag in entities.get(entity, [])):
                        continue
                    count += n
                    for row in rows:
                        p = [nodes[int(tag)] for tag in row[1:9]]
                        for a, b in ((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 5), (2, 6), (3, 7)):
                            shortest = min(shortest, float(np.linalg.norm(p[a] - p[b])))
        return (shortest, count) if count else None
    except (OSError, ValueError, StopIteration, KeyError, IndexError):
        return None


def fem_mesh(case):
    """(least length [m], elements, surface facets or None)."""
    block = case["fem"]["block"]
    if block is None:
        rigid = {body["set"] for body in case["fem"]["rigid"]}
        found = read_hexahedra(Path(case["folder"]) / case["fem"]["mesh"], rigid)
        return (*found, None) if found else None
    n = block["divisions"]
    extents = [block["box"]["max"][k] - block["box"]["min"][k] for k in range(3)]
    if block.get("cells") == "shells":              # a sheet, touched from both sides
        elements = math.prod(count for count in n if count > 0)
        return min(e / count for e, count in zip(extents, n) if count > 0), elements, 2 * elements * len(case["fem"]["surface"])
    lengths = [e / count for e, count in zip(extents, n)]
    facets = {"x": n[1] * n[2], "y": n[0] * n[2], "z": n[0] * n[1]}
    in_six = block.get("cells") == "tetrahedra"     # whose heights are about half a cell's edge
    return (min(lengths) * (0.5 if in_six else 1), math.prod(n) * (6 if in_six else 1),
            sum(facets[s["set"][0]] for s in case["fem"]["surface"]) * (2 if in_six else 1))


def wave_speed(material):
    """c_p = sqrt(E (1-nu) / ((1+nu)(1-2nu) rho))  [m/s]"""
    e, nu, rho = (material[k] for k in ("young_modulus", "poisson_ratio", "density"))
    return math.sqrt(e * (1 - nu) / ((1 + nu) * (1 - 2 * nu) * rho))


def fem_step(case, length):
    """(dt [s], what limits it): the fastest material in the smallest element; None when rigid bodies
    and implicit parts, which limit no step, are all there is."""
    rigid = {body["set"] for body in case["fem"]["rigid"]}
    used = {part["material"] for part in case["fem"]["part"]
            if part["set"] not in rigid and not part["implicit"]}
    if not used:
        return None
    fastest = max((m for m in case["fem"]["material"] if m["name"] in used), key=wave_speed)
    c = wave_speed(fastest)
    return case["fem"]["cfl"] * length / c, f"element, {fastest['name']}: L = {length:.3g} m, c_p = {c:.4g} m/s"


def contact_facts(case):
    """Particles of half a spacing against facets: lines about the interface."""
    dx = case["sph"]["spacing"]
    lines = [f"contact radius {dx / 2:.3g} m, search skin {case['coupling']['skin'] * dx:.3g} m, "
             f"law {case['coupling']['law']}, beta {case['coupling']['beta']:g}, damping {case['coupling']['damping']:g}"]
    mesh = fem_mesh(case) if case["fem"] else None
    if mesh and mesh[2]:
        names = ", ".join(s["name"] for s in case["fem"]["surface"])
        lines.append(f"surface {names}: {mesh[2]:,} facets")
    for patch in case["coupling"]["patch"]:
        size = [patch["box"]["max"][k] - patch["box"]["min"][k] for k in range(3)]
        if sorted(size)[0] < dx * (1 - 1e-9):
            lines.append(f"patch {patch['name']} is thinner than a particle spacing: it will often be empty")
    return lines


def estimate(case, threads):
    """A dict with everything `undertow check` prints."""
    result = {"particles": 0, "elements": 0, "steps_of": {}, "notes": []}
    work_s, dts = [], []
    if case["sph"]:
        result["particles"] = particles(case)
        dt, why = sph_step(case)
        dts.append((dt, f"sph: {why}"))
    if case["fem"]:
        mesh = fem_mesh(case)
        if mesh:
            result["elements"] = mesh[1]
            step = fem_step(case, mesh[0])
            if step:
                dts.append((step[0], f"fem: {step[1]}"))
        else:
            result["notes"].append(f"{case['fem']['mesh']} is no ASCII Gmsh 4.1 file of hexahedra: its step is not estimated")
    dt, limiter = min(dts, default=(math.nan, "-"))
    if case["time"]["max_step"] and case["time"]["max_step"] < dt:
        dt, limiter = case["time"]["max_step"], "time.max_step"
    margin = SPH_STEP_MARGIN if limiter.startswith("sph") else 1.0
    steps = case["time"]["end"] / (margin * dt)
    if result["particles"]:
        work_s.append(result["particles"] * steps / (particle_rate(case, dt) * threads))
    # The FEM solver has one thread beside the particle solver's, and computes at the same time
    # only if a core is free.
    eight_points = case["fem"] and any(part.get("element") == "b_bar" for part in case["fem"]["part"])
    work_s.append(result["elements"] * steps / (BBAR_STEPS_PER_S if eight_points else ELEMENT_STEPS_PER_S))
    if case["coupled"]:
        work_s.append(steps * SECONDS_PER_COUPLED_STEP)
        result["notes"] += contact_facts(case)
    frames = case["time"]["end"] / case["output"]["fields_every"]
    result.update(dts=dts, dt=dt, limiter=limiter, steps=steps, wall_s=sum(work_s),
                  memory=result["particles"] * PARTICLE_BYTES + result["elements"] * ELEMENT_BYTES,
                  disk=frames * (result["particles"] * 40 + result["elements"] * 100))
    return result
