"""What a participant must do, one function a check: docs/protocol.md, section Conformance.

A check gets a `meet`, which opens a new Meeting, and raises Broken with a sentence when the participant
fails it. A check may return a remark. A fault is answered by an ERROR with one of the codes expected of
it, said once, and by the end of the program.
"""
import math
import random
from dataclasses import dataclass

import msgpack
import numpy as np

from undertow_protocol import (ACTIVE, ERROR, FORCE, LAYOUT, MESH, MESH_ACK, PROBE, PROGRESS, PROTOCOL, STATE_STOP,
                               VERSION, encode)

from .coupler import Broken, Gone, name_of

ENDS = 10.0         # [s] for a program to end once it knows that it must


class Skipped(Exception):
    """The check does not apply here; the text says why."""


def require(holds, sentence):
    if not holds:
        raise Broken(sentence)


@dataclass
class Check:
    name: str
    what: str       # in the table
    run: object


ALL = []


def check(what):
    def add(function):
        ALL.append(Check(function.__name__, what, function))
        return function
    return add


# ---------------------------------------------------------------- a run in good order

@check("HELLO: protocol, version, name, role, units")
def greeting(meet):
    with meet() as m:
        hello = m.greet()
        require(hello["p"] == PROTOCOL, f"p is {hello['p']!r}, not {PROTOCOL!r}")
        require(hello["v"][0] == VERSION[0], f"it speaks version {hello['v']}, this coupler {VERSION}")
        name = hello["name"]
        require(0 < len(name) <= 64 and all(c.isascii() and (c.isalnum() or c in "_-.") for c in name),
                f"the name {name!r} is not 1 to 64 letters, digits, _ - and .")
        require(hello["role"] in ("surface", "particles"), f"the role is {hello['role']!r}")
        require(hello["units"] == "SI", f"units are {hello['units']!r}")
        require(all(" = " in line for line in hello.get("case", [])), "case is not a list of KEY = VALUE")
        return f"{name}, {hello['role']}, {hello['sw'] or 'no software named'}"


@check("MESH: masses, indices, groups")
def mesh(meet):
    with meet() as m:
        meshes = m.prepare()
        for one in meshes:
            require(one["kind"] == m.hello["role"], f"kind {one['kind']!r} of a {m.hello['role']}")
            if m.particles():
                require(one["r"] > 0 and one["groups"], "particles announce a radius > 0 and their phases")
                continue
            require(len(one["x"]) >= 3 and (one["mass"] > 0).all(), "every node has a mass > 0")
            require(len(one["quad"]) > 0 and one["quad"].min() >= 0 and one["quad"].max() < len(one["x"]),
                    "facets name nodes that are not there, or there are none")
            require(one["group"].min() >= 0 and one["group"].max() < len(one["groups"]), "a group is not named")
            a, b = (one["x"][one["quad"][:, i + 2]] - one["x"][one["quad"][:, i]] for i in (0, 1))
            require((np.linalg.norm(np.cross(a, b), axis=1) > 0).all(), "a facet has no area")
        return f"{m.rows} nodes" if not m.particles() else f"radius {meshes[0]['r']:g} m"


def drift(before, after, dt):
    """How far x^{n+1} is from x^n + dt v^{n+1/2}, relative to the largest way of a node in a step."""
    way = dt * after["v"]
    largest = np.abs(way).max(initial=0.0)
    return np.abs(after["x"] - before["x"] - way).max(initial=0.0), largest, np.abs(after["x"]).max(initial=1.0)


@check("20 steps: n counts, t is t1 in every bit, rows, finite, dl > 0")
def steps(meet):
    with meet() as m:
        m.prepare()
        before = None
        for step in range(20):
            now = m.state(m.particles() and step == 0)
            require(now["s"] == m.session, f"{name_of(now)} has the session {now['s']}")
            require(now["n"] == m.n, f"{name_of(now)} came in step {m.n}")
            require(now["t"] == m.t, f"{name_of(now)} is at t = {now['t']!r}, t1 was {m.t!r}")
            require(now["dl"] > 0, f"{name_of(now)} offers a step of {now['dl']}")
            require(now["m"] == PROBE or len(now["x"]) == m.rows, f"{len(now['x'])} rows, agreed were {m.rows}")
            before = now
            m.answer(now, active=range(min(50, m.step_rows)))
        m.state()
        return f"offers {before['dl']:.3g} s ({before['lim']})"


@check("velocities are those of t - dt/2: x moves by dt v")
def leapfrog(meet):
    with meet() as m:
        m.prepare()
        if m.particles():
            raise Skipped("particles may be shifted")
        load = np.zeros((m.rows, 3))
        load[:] = (0.3, 0.2, -1.0)
        before = m.state()
        worst, extent = 0.0, float(np.ptp(before["x"], axis=0).max())
        for _ in range(10):
            dt = m.answer(before, f=load)
            now = m.state()
            error, way, size = drift(before, now, dt)
            # a body that turns by way/extent moves on arcs, way^2/extent beside the chord
            require(error <= 1e-6 * way + way * way / extent + 1e-13 * size,
                    f"{name_of(now)}: x moved by up to {way:.3g} m, but by {error:.3g} m otherwise than dt v")
            worst, before = max(worst, error / way if way > 0 else 0.0), now
        require(way > 0, "no node moves under a load on all of them")
        return f"to {worst:.1e} of the way"


@check("the first kick is half a step")
def half_kick(meet):
    def speed(load):
        with meet() as m:
            m.prepare()
            if m.particles():
                raise Skipped("particles carry pressure of their own")
            first = m.state()
            m.answer(first, dt=1e-3 * first["dl"], f=np.full((m.rows, 3), 1.0) * load)
            one = m.state()["v"]
            m.answer(first, dt=1e-3 * first["dl"], f=np.full((m.rows, 3), 1.0) * load)
            return one, m.state()["v"]
    (idle1, idle2), (one, two) = speed(0.0), speed(1.0)
    gained, again = np.abs(one - idle1).sum(), np.abs((two - idle2) - (one - idle1)).sum()
    require(gained > 0, "no node moves under a load on all of them")
    require(abs(gained / again - 0.5) < 0.05,
            f"the first step gains {gained / again:.3g} of the velocity that a later one does; 0.5 is due")
    return f"{gained / again:.4f} of a later one"


@check("the active list: replaced by each ACTIVE, also by an empty one")
def active_list(meet):
    with meet() as m:
        m.prepare()
        if not m.particles():
            raise Skipped("a surface has none")
        probe = m.state(probe=True)
        for chosen in (range(min(5, m.step_rows)), range(0), range(0, m.step_rows, 2)):
            ids = probe["id"][list(chosen)]
            m.answer(probe, active=chosen, probe=False)
            state = m.state()
            require(len(state["x"]) == len(ids), f"{len(state['x'])} rows after an ACTIVE of {len(ids)}")
            require(len(set(probe["id"].tolist())) == len(probe["id"]), "an identity comes twice")
            m.answer(state, probe=True)
            probe = m.state(probe=True)
        return f"{m.step_rows} particles"


@check("headers are canonical")
def canonical(meet):
    with meet() as m:
        m.prepare()
        m.steps(3)
        for header, message in m.headers:
            require(header == encode(message)[0],
                    f"{name_of(message)}: keys in another order, or numbers in another form, than the tables")


@check("FINISH is answered with BYE, then the program ends with 0")
def finish(meet):
    with meet() as m:
        m.prepare()
        m.steps(3)
        m.finish()
        if m.process:
            code = m.exit_code(ENDS)
            require(code == 0, f"it {'still runs' if code is None else f'ended with {code}'}")


def shuffled(message, session):
    """The message as a later minor version may send it: other order, more keys, more arrays."""
    header, *arrays = encode(message)
    keys = list(msgpack.unpackb(header).items())
    random.Random(7).shuffle(keys)
    keys = {**dict(keys), "later": {"x": None, "y": [True, b"raw"]}}
    keys["a"] = [["later", "f4", [3]], *keys["a"]]
    return [msgpack.packb(keys), bytes(12), *arrays]


@check("accepts keys in any order, unknown keys and unknown arrays")
def later_minor(meet):
    with meet() as m:
        plain = m.send_frames
        m.send_frames = lambda frames, by_socket=True: plain(frames, by_socket)
        m.send = lambda kind, **keys: plain(shuffled({"m": kind, "s": m.session, "n": m.n, **keys}, m.session),
                                            kind != FORCE)
        m.prepare()
        m.steps(5)
        m.finish()


@check("ignores PROGRESS, and its deadline starts anew with it")
def progress(meet):
    with meet(deadline=2.0) as m:
        m.prepare()
        state = m.steps(2)
        for part in range(5):
            m.send(PROGRESS, frac=0.2 * part, text="conform waits")
            m.socket.poll(700)
        m.answer(state, active=())
        m.state()


@check("Ctrl-C: flag 1, goes on until FINISH, ends with 130")
def interrupt(meet):
    with meet() as m:
        if not m.process:
            raise Skipped("the program is not ours to interrupt")
        m.prepare()
        state = m.steps(3)
        m.interrupt()
        for _ in range(20):
            if state["fl"] & STATE_STOP:
                break
            m.answer(state, dt=1e-6 * state["dl"])
            state = m.state()
            m.socket.poll(50)
        require(state["fl"] & STATE_STOP, "no STATE had flag 1 after SIGINT")
        m.finish("interrupted")
        code = m.exit_code(ENDS)
        require(code == 130, f"it {'still runs' if code is None else f'ended with {code}'}")


# ---------------------------------------------------------------- faults

def expect_refusal(m, codes, within=ENDS):
    """An ERROR with one of these codes, nothing after it, and the end of the program."""
    error = m.receive(ERROR, seconds=within)
    require(error["code"] in codes, f"it said {error['code']}: {error['text']}; due is {' or '.join(codes)}")
    require(error["text"].strip(), f"{error['code']} came without a sentence")
    expect_end(m)


def expect_end(m):
    try:
        late = m.receive(*LAYOUT, seconds=2.0)
        raise Broken(f"{name_of(late)} came after the error")
    except Gone:
        pass
    except Broken as silence:
        if "came within" not in str(silence):
            raise
    if m.process:
        code = m.exit_code(ENDS)
        require(code not in (None, 0), "it still runs" if code is None else "it ended with 0")
        require(code > 0, f"it was ended by signal {-code}")


def force_of(m, **other):
    return {"m": FORCE, "s": m.session, "n": m.n, "dt": 1e-9, "t1": m.t + 1e-9, "fl": 0, "lim": "conform",
            "f": np.zeros((m.step_rows, 3)), **other}


def spoil(m, state, message=None, frames=None):
    """ACTIVE of all rows, if one is due, then the wrong answer."""
    if state["m"] == PROBE:
        m.send(ACTIVE, row=list(range(m.step_rows)))
        m.by_segment = False
    frames = frames or encode(message)
    m.send_frames(frames, by_socket=False)


def wrong_force(what, codes, change):
    def run(meet):
        with meet() as m:
            m.prepare()
            state = m.steps(2)
            spoil(m, state, force_of(m, **change(m)))
            expect_refusal(m, codes)
    run.__name__ = what.replace(" ", "_")
    check(f"FORCE {what}: {' or '.join(codes)}")(run)


for _what, _codes, _change in (
        ("of another session", ["E_SEQUENCE"], lambda m: {"s": m.session + 1}),
        ("of the next step", ["E_SEQUENCE"], lambda m: {"n": m.n + 1}),
        ("of the last step", ["E_SEQUENCE"], lambda m: {"n": m.n - 1}),
        ("with a row too many", ["E_SHAPE"], lambda m: {"f": np.zeros((m.step_rows + 1, 3))}),
        ("with a NaN", ["E_NONFINITE"], lambda m: {"f": np.full((m.step_rows, 3), np.nan)} if m.step_rows else {"dt": math.nan}),
        ("with dt infinite", ["E_NONFINITE"], lambda m: {"dt": math.inf}),
        ("with dt = 0", ["E_TIME", "E_NONFINITE"], lambda m: {"dt": 0.0}),
        ("with dt < 0", ["E_TIME", "E_NONFINITE"], lambda m: {"dt": -1e-9}),
        ("with t1 = t", ["E_TIME"], lambda m: {"t1": m.t})):
    wrong_force(_what, _codes, _change)


def wrong_bytes(what, codes, make):
    def run(meet):
        with meet() as m:
            m.prepare()
            state = m.steps(2)
            spoil(m, state, frames=make(encode(force_of(m))))
            expect_refusal(m, codes)
    run.__name__ = what.replace(" ", "_")
    check(f"{what}: {' or '.join(codes)}")(run)


def changed(header, **other):
    return msgpack.packb({**msgpack.unpackb(header), **other})


def without(header, key):
    return msgpack.packb({k: v for k, v in msgpack.unpackb(header).items() if k != key})


for _what, _codes, _make in (
        ("a header cut short", ["E_MALFORMED"], lambda f: [f[0][:-5], *f[1:]]),
        ("bytes behind the map", ["E_MALFORMED"], lambda f: [f[0] + b"\x00", *f[1:]]),
        ("a header of 70 kB", ["E_MALFORMED"], lambda f: [changed(f[0], pad="x" * 70000), *f[1:]]),
        ("a map that claims 4 billion entries", ["E_MALFORMED"], lambda f: [b"\xdf\xff\xff\xff\xff" + f[0][1:], *f[1:]]),
        ("an unknown type", ["E_MALFORMED"], lambda f: [changed(f[0], m=99), *f[1:]]),
        ("a key missing", ["E_MALFORMED"], lambda f: [without(f[0], "dt"), *f[1:]]),
        ("a text where a number is due", ["E_MALFORMED"], lambda f: [changed(f[0], dt="1e-6"), *f[1:]]),
        ("an array missing", ["E_MALFORMED", "E_SHAPE"], lambda f: [changed(f[0], a=[])]),
        ("a frame missing", ["E_SHAPE"], lambda f: f[:1]),
        ("a frame too long", ["E_SHAPE"], lambda f: [f[0], f[1] + bytes(8)]),
        ("an unknown dtype", ["E_SHAPE"], lambda f: [changed(f[0], a=[["f", "f2", [len(f[1]) // 2]]]), *f[1:]]),
        ("another dtype than agreed", ["E_SHAPE"], lambda f: [changed(f[0], a=[["f", "i8", [len(f[1]) // 24, 3]]]), *f[1:]]),
        ("random bytes", ["E_MALFORMED"], lambda f: [random.Random(1).randbytes(200)])):
    wrong_bytes(_what, _codes, _make)


@check("a message that is not due: E_STATE")
def not_due(meet):
    with meet() as m:
        m.prepare()
        m.steps(2)
        m.send(MESH_ACK, mesh="again", rev=0, sum="0" * 16)
        expect_refusal(m, ["E_STATE"])


@check("WELCOME of another major version: E_VERSION")
def other_version(meet):
    with meet() as m:
        m.greet()
        m.welcome(v=[VERSION[0] + 1, 0])
        expect_refusal(m, ["E_VERSION"])


@check("WELCOME of another minor version, older or newer: goes on")
def other_minor_version(meet):
    for minor in (0, VERSION[1] + 7):
        with meet() as m:
            m.greet()
            m.welcome(v=[VERSION[0], minor])
            m.meshes()
            m.steps(2)


@check("MESH_ACK with another checksum: E_MESH")
def other_checksum(meet):
    with meet() as m:
        m.greet()
        m.welcome()
        mesh_message = m.receive(MESH)
        m.send(MESH_ACK, mesh=mesh_message["mesh"], rev=mesh_message["rev"], sum="0123456789abcdef")
        expect_refusal(m, ["E_MESH"])


@check("ERROR instead of WELCOME: ends, says nothing")
def refused(meet):
    with meet() as m:
        m.greet()
        m.send(ERROR, code="E_LATE", text="every place is taken", who="")
        expect_end(m)


@check("ERROR in a step: ends, says nothing")
def error_in_step(meet):
    with meet() as m:
        m.prepare()
        m.steps(2)
        m.send(ERROR, code="E_PEER_LOST", text="the other one vanished", who="other")
        expect_end(m)


@check("a coupler that is silent past the deadline: E_TIMEOUT")
def silence(meet):
    with meet(deadline=1.5) as m:
        m.prepare()
        m.steps(2)
        expect_refusal(m, ["E_TIMEOUT"], within=1.5 + ENDS)


@check("a connection that breaks: ends at once, with code 3")
def hang_up(meet):
    with meet(deadline=60.0) as m:
        if not m.process:
            raise Skipped("the program is not ours to watch")
        m.prepare()
        m.steps(2)
        m.hang_up()
        code = m.exit_code(ENDS)
        require(code == 3, f"it {'still runs' if code is None else f'ended with {code}'}")


def golden_check(path):
    frames, code = [], None
    for line in path.read_text(encoding="ascii").splitlines():
        if line.startswith("# expect "):
            code = line.split()[2]
        elif not line.startswith("#"):
            frames.append(b"" if line == "-" else bytes.fromhex(line))

    def run(meet):
        with meet() as m:
            m.prepare()
            m.steps(1)
            m.send_frames(frames, by_socket=False)
            expect_refusal(m, [code])
    return Check(path.stem, f"golden bytes of {path.stem}: {code}", run)
