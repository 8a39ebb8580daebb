#!/usr/bin/python3
"""Protocol version 1 for Python programs: bytes <-> messages, and a solver's end of the link.

A message is a dict: key "m" is its type, the other keys and the arrays stand beside it under the
names of docs/protocol.md (numpy arrays, SI units). Needs pyzmq, msgpack and numpy.

    link = Participant(endpoint, name="wall", role="surface", software="my backend 1.0")
    link.announce(mesh="wall", groups=["wall"], x=x, mass=mass, quad=quad, group=group)
    t, n = link.welcome["t0"], link.welcome["n0"]
    while True:
        link.send_state(n, t, dt_limit, x, v)
        ... internal forces ...                  # while the coupler computes the contact
        reply = link.wait_reply()
        if reply.finish:
            break
        ... kick and drift with reply.force["f"] and reply.force["dt"] ...
        t, n = reply.force["t1"], n + 1
    link.say_goodbye(n)
"""
import dataclasses
import math
import pathlib
import time

import msgpack
import numpy as np
import zmq
from zmq.utils.monitor import recv_monitor_message

VERSION = [1, 1]
PROTOCOL = "undertow"
MAX_HEADER = 64 * 1024      # [byte]
MAX_DEPTH = 4
MAX_ARRAYS = 16
MAX_MESSAGE = 512 << 20     # [byte] per frame

(HELLO, WELCOME, MESH, MESH_ACK, STATE, FORCE, CHECKPOINT, CHECKPOINT_ACK, FINISH, BYE, ERROR,
 PROGRESS) = range(1, 13)
ACTIVE, PROBE, SURFACE = 14, 15, 16

HANDSHAKE_FAILED = (zmq.EVENT_HANDSHAKE_FAILED_NO_DETAIL | zmq.EVENT_HANDSHAKE_FAILED_PROTOCOL
                    | zmq.EVENT_HANDSHAKE_FAILED_AUTH)

STATE_STOP = 1      # STATE, PROBE: the user asked this participant to stop
FORCE_PROBE = 1     # FORCE: answer the next step with PROBE
FORCE_OUTPUT = 2    # FORCE: t1 is a common output time

# Keys in their order on the wire with the kind of their values; arrays as name, dtype, columns
# (1: shape (N), otherwise (N, columns)). i: integer, f: number, t: text, T: list of texts,
# V: [major, minor]; T?: T, left out while it is empty or not given.
_STEP = "s:i n:i "
LAYOUT = {
    HELLO: ("HELLO", "p:t v:V name:t role:t caps:T sw:t units:t case:T?", ""),
    WELCOME: ("WELCOME", "s:i v:V caps:T n0:i t0:f te:f deadline:f share:f max:i", ""),
    MESH: ("MESH", "s:i mesh:t rev:i kind:t groups:T r:f h:f",
           "x:f8:3 mass:f8:1 quad:i4:4 group:i4:1"),
    MESH_ACK: ("MESH_ACK", "s:i mesh:t rev:i sum:t", ""),
    SURFACE: ("SURFACE", _STEP + "range:f", "x:f8:3 quad:i4:4 boxes:f8:6"),
    PROBE: ("PROBE", _STEP + "t:f dl:f lim:t fl:i work:f wait:f",
            "id:u8:1 x:f8:3 v:f8:3 mass:f8:1 r:f8:1 k:f8:1 phase:u4:1"),
    ACTIVE: ("ACTIVE", _STEP, "row:u4:1"),
    STATE: ("STATE", _STEP + "t:f dl:f rev:i lim:t fl:i reach:f work:f wait:f", "x:f8:3 v:f8:3"),
    FORCE: ("FORCE", _STEP + "dt:f t1:f fl:i lim:t", "f:f8:3"),
    CHECKPOINT: ("CHECKPOINT", _STEP + "id:t", ""),
    CHECKPOINT_ACK: ("CHECKPOINT_ACK", _STEP + "file:t sha:t", ""),
    FINISH: ("FINISH", _STEP + "reason:t", ""),
    BYE: ("BYE", _STEP, ""),
    ERROR: ("ERROR", _STEP + "code:t text:t who:t", ""),
    PROGRESS: ("PROGRESS", _STEP + "frac:f text:t", ""),
}
LAYOUT = {m: (name, [tuple(k.split(":")) for k in keys.split()],
              [(a, d, int(c)) for a, d, c in (s.split(":") for s in arrays.split())])
          for m, (name, keys, arrays) in LAYOUT.items()}
SAME_ROWS = {STATE: [("x", "v")], MESH: [("x", "mass"), ("quad", "group")],
             PROBE: [("id", other) for other in ("x", "v", "mass", "r", "k", "phase")]}


class PeerError(Exception):
    """A peer failed or broke the protocol; `code` is one of the E_ codes of docs/protocol.md."""

    def __init__(self, code, text):
        super().__init__(text)
        self.code = code


# ---------------------------------------------------------------- bytes <-> messages

def encode(message):
    """The frames of a message: the header, then one bytes-like object per array."""
    name, keys, arrays = LAYOUT[message["m"]]
    header, entries, frames = {"m": message["m"]}, [], []
    for key, kind in keys:
        if kind == "T?" and not message.get(key):
            continue
        header[key] = float(message[key]) if kind == "f" else message[key]
    for array, dtype, columns in arrays:
        shape = (-1,) if columns == 1 else (-1, columns)
        data = np.ascontiguousarray(message[array], "<" + dtype).reshape(shape)
        entries.append([array, dtype, list(data.shape)])
        frames.append(data.tobytes())
    header["a"] = entries
    packed = msgpack.packb(header)
    if len(packed) > MAX_HEADER:
        raise ValueError(f"the header of {name} passes the limit of 64 kB")
    return [packed] + frames


def _depth(value):
    if isinstance(value, dict):
        return 1 + max(map(_depth, value.values()), default=0)
    return 1 + max(map(_depth, value), default=0) if isinstance(value, list) else 0


def _pairs(pairs):
    keys = [key for key, _ in pairs]
    if len(set(keys)) != len(keys) or not all(isinstance(key, str) for key in keys):
        raise ValueError("a key comes twice or is not a text")
    return dict(pairs)


def _unpack(raw):
    if len(raw) > MAX_HEADER:
        raise PeerError("E_MALFORMED", f"a header of {len(raw)} bytes passes the limit of 64 kB")
    try:
        header = msgpack.unpackb(raw, object_pairs_hook=_pairs, strict_map_key=False,
                                 max_ext_len=0, unicode_errors="replace")
    except Exception as error:      # msgpack raises a dozen kinds; all mean the same here
        raise PeerError("E_MALFORMED", f"the header is no MessagePack map: {error}") from None
    if not isinstance(header, dict) or _depth(header) > MAX_DEPTH:
        raise PeerError("E_MALFORMED", "the header is no map or nested deeper than 4 levels")
    if header.get("m") not in LAYOUT or isinstance(header["m"], (bool, float)):
        raise PeerError("E_MALFORMED", f"the message type m = {header.get('m')} is unknown")
    return header


def _is_integer(value):
    return isinstance(value, int) and not isinstance(value, bool)


_KINDS = {
    "i": _is_integer,
    "f": lambda value: _is_integer(value) or isinstance(value, float),
    "t": lambda value: isinstance(value, str),
    "T": lambda value: isinstance(value, list) and all(isinstance(t, str) for t in value),
    "T?": lambda value: _KINDS["T"](value),
    "V": lambda value: (isinstance(value, list) and len(value) == 2
                        and all(_is_integer(number) and number >= 0 for number in value)),
}


def _array(message, label, name, dtype, columns, entries, frames):
    found = [i for i, entry in enumerate(entries) if entry[0] == name]
    if len(found) != 1:
        raise PeerError("E_MALFORMED", f"{label}: array {name} comes {len(found)} times")
    _, its_dtype, shape = entries[found[0]]
    if its_dtype != dtype:
        raise PeerError("E_SHAPE", f"{label}: {name} has dtype {its_dtype}, expected {dtype}")
    if len(shape) != (1 if columns == 1 else 2) or (columns > 1 and shape[1] != columns):
        raise PeerError("E_SHAPE", f"{label}: {name} has shape {shape}, not (N, {columns})")
    data = np.frombuffer(frames[found[0]], "<" + dtype).reshape(shape)
    if dtype[0] == "f" and not np.isfinite(data).all():
        place = tuple(int(i) for i in np.argwhere(~np.isfinite(data))[0])
        raise PeerError("E_NONFINITE", f"{label}: {name}{list(place)} is {data[place]}")
    message[name] = data


def decode(frames):
    """The message of these frames, or PeerError: E_MALFORMED, E_SHAPE, E_NONFINITE."""
    header, frames = _unpack(bytes(frames[0])), frames[1:]
    label, keys, arrays = LAYOUT[header["m"]]
    message = {"m": header["m"]}
    if _is_integer(header.get("n")):
        label = f"{label}({header['n']})"
    for key, kind in keys:
        if kind == "T?" and key not in header:
            continue
        if key not in header:
            raise PeerError("E_MALFORMED", f"{label}: key {key} is missing")
        value = header[key]
        if not _KINDS[kind](value):
            raise PeerError("E_MALFORMED", f"{label}: key {key} has the wrong kind: {value!r}")
        if kind == "f" and not math.isfinite(value):
            raise PeerError("E_NONFINITE", f"{label}: key {key} is {value}")
        message[key] = float(value) if kind == "f" else value
    entries = header.get("a")
    if not isinstance(entries, list) or len(entries) > MAX_ARRAYS or not all(
            isinstance(e, list) and len(e) == 3 and isinstance(e[0], str) and isinstance(e[1], str)
            and isinstance(e[2], list) and all(_is_integer(n) and n >= 0 for n in e[2])
            for e in entries):
        raise PeerError("E_MALFORMED", f"{label}: key a is no list of [name, dtype, shape]")
    if len(entries) != len(frames):
        raise PeerError("E_SHAPE", f"{label}: {len(entries)} arrays, but {len(frames)} frames")
    for (name, dtype, shape), frame in zip(entries, frames):
        if dtype not in ("f8", "f4", "i4", "u4", "i8", "u8"):
            raise PeerError("E_SHAPE", f"{label}: {name} has the unknown dtype {dtype}")
        if int(dtype[1]) * math.prod(shape) != len(frame):
            raise PeerError("E_SHAPE", f"{label}: the frame of {name} has {len(frame)} bytes")
    for name, dtype, columns in arrays:
        _array(message, label, name, dtype, columns, entries, frames)
    for first, second in SAME_ROWS.get(header["m"], []):
        if len(message[first]) != len(message[second]):
            raise PeerError("E_SHAPE", f"{label}: {first} and {second} differ in their rows")
    return message


def checksum(mesh):
    """FNV-1a, 64 bits, over the bytes of the mesh's arrays; 16 hex digits, as in MESH_ACK."""
    total = 0xcbf29ce484222325
    for frame in encode(mesh)[1:]:
        for byte in frame:
            total = (total ^ byte) * 0x100000001b3 & 0xffffffffffffffff
    return f"{total:016x}"


def read_key(folder, file):
    """{"public": ..., "secret": ...} of a key file."""
    try:
        words = (pathlib.Path(folder) / file).read_text(encoding="ascii").split()
    except OSError as error:
        raise ValueError(f"a key is missing: {error}; make keys with `undertow keys FOLDER`") from None
    return {name: key.encode() for name, key in zip(words[::2], words[1::2])}


# ---------------------------------------------------------------- the solver's end of the link

@dataclasses.dataclass
class Reply:
    """What came back for a step: exactly one of force, checkpoint and finish is set."""
    surface: dict = None
    active: dict = None
    force: dict = None
    checkpoint: dict = None
    finish: dict = None


class Participant:
    """HELLO on construction; then announce(), the steps, say_goodbye(). Every wait has an end."""

    def __init__(self, endpoint, name, role, software="", capabilities=(), join_timeout=60,
                 stop=lambda: False, keys=None, case_keys=()):
        """case_keys: lines of `undertow_case CASE --binding`, which the coupler compares with those of its
        own case; who has another one is refused (E_INPUT). None: nothing is compared.
        keys: folder made by `undertow keys`, for a coupler on another host.
        stop: asked until the first step; true ends the run with E_STOP (the user's Ctrl-C)."""
        self.endpoint, self.name, self.role = endpoint, name, role
        self.session, self.n, self.t = 0, 0, None
        self.rows = 0            # of STATE and FORCE: all nodes, or the active particles
        self.waited = 0.0        # [s] in wait_reply()
        self._ended = self._lost = self._active_due = False
        self._stop = stop
        if not endpoint.startswith(("ipc://", "tcp://" if keys else "tcp://127.0.0.1:")):
            raise ValueError(f"endpoint '{endpoint}' is neither ipc://... nor tcp://127.0.0.1:PORT; "
                             "remote endpoints need CURVE keys: make some with `undertow keys FOLDER`")
        self._context = zmq.Context()
        self._socket = self._context.socket(zmq.DEALER)
        for option, value in ((zmq.LINGER, 0), (zmq.SNDHWM, 16), (zmq.RCVHWM, 16),
                              (zmq.RECONNECT_IVL, 20),
                              (zmq.RECONNECT_IVL_MAX, 200), (zmq.MAXMSGSIZE, MAX_MESSAGE)):
            self._socket.setsockopt(option, value)
        self._has_keys = bool(keys) and endpoint.startswith("tcp://")
        if self._has_keys:
            own = read_key(keys, name + ".key")
            self._socket.curve_publickey, self._socket.curve_secretkey = own["public"], own["secret"]
            self._socket.curve_serverkey = read_key(keys, "coupler.pub")["public"]
        self._monitor = self._socket.get_monitor_socket(zmq.EVENT_DISCONNECTED | HANDSHAKE_FAILED)
        self._poller = zmq.Poller()
        self._poller.register(self._socket, zmq.POLLIN)
        self._poller.register(self._monitor, zmq.POLLIN)
        self._socket.connect(endpoint)
        self._patience = join_timeout
        try:
            self._send({"m": HELLO, "p": PROTOCOL, "v": VERSION, "name": name, "role": role,
                        "caps": list(capabilities), "sw": software, "units": "SI", "case": list(case_keys)})
            self.welcome = self._take(WELCOME)
            self.session, self.n = self.welcome["s"], self.welcome["n0"]
            self.t = self.welcome["t0"]
            if self.welcome["v"][0] != VERSION[0]:
                self._fail("E_VERSION", f"the coupler speaks protocol {self.welcome['v']}, "
                                        f"this program {VERSION}")
            self._patience = self.welcome["deadline"]
        except BaseException:
            self.close()
            raise
        self._join_timeout = join_timeout

    # ------------------------------------------------------------ the life cycle

    def announce(self, **mesh):
        """Sends MESH and waits for its MESH_ACK. A surface gives mesh, groups, x, mass, quad, group
        and h (shell thickness); particles give mesh, groups and r (contact radius)."""
        empty = {"rev": 0, "kind": self.role, "r": 0.0, "h": 0.0, "x": [], "mass": [], "quad": [],
                 "group": []}
        message = {**empty, **mesh, "m": MESH, "s": self.session}
        self._send(message)
        if self._take(MESH_ACK)["sum"] != checksum(message):
            self._fail("E_MESH", f"mesh {message['mesh']} changed on its way")
        self.rows += len(np.reshape(message["x"], (-1, 3)))

    def wait_surface(self):
        """Particles: the first SURFACE, which comes when all meshes are in."""
        return self._take(SURFACE, patience=max(self._join_timeout, self._patience))

    def send_state(self, n, t, dt_limit, x, v, limiter="", flags=0, reach=0.0, work=0.0):
        self._check_step(n, t)
        self._send({"m": STATE, "s": self.session, "n": n, "t": t, "dl": dt_limit, "rev": 0,
                    "lim": limiter, "fl": flags, "reach": reach, "work": work, "wait": self.waited,
                    "x": x, "v": v})

    def send_probe(self, n, t, dt_limit, limiter="", flags=0, work=0.0, **arrays):
        """arrays: id, x, v, mass, r, k, phase of every particle in the boxes of SURFACE."""
        self._check_step(n, t)
        self._active_due = True
        self._send({"m": PROBE, "s": self.session, "n": n, "t": t, "dl": dt_limit, "lim": limiter,
                    "fl": flags, "work": work, "wait": self.waited, **arrays})

    def send_progress(self, fraction, text):
        """Restarts the coupler's deadline in a long step."""
        self._send({"m": PROGRESS, "s": self.session, "n": self.n, "frac": fraction, "text": text})

    def send_checkpoint_ack(self, file, sha256):
        self._send({"m": CHECKPOINT_ACK, "s": self.session, "n": self.n, "file": file,
                    "sha": sha256})

    def wait_reply(self):
        """The answer to the last STATE or PROBE. Checks step, rows, time and finiteness."""
        start, reply = time.monotonic(), Reply()
        while not (reply.force or reply.checkpoint or reply.finish):
            message = self._take(SURFACE, ACTIVE, FORCE, CHECKPOINT, FINISH)
            kind = LAYOUT[message["m"]][0].lower()
            if message["m"] != FINISH and message["n"] != self.n:
                self._fail("E_SEQUENCE", f"{kind} of step {message['n']} came in step {self.n}")
            setattr(reply, kind, message)
            if reply.active:
                self.rows, self._active_due = len(reply.active["row"]), False
        if reply.force:
            self._check_force(reply.force)
            self.n, self.t = self.n + 1, reply.force["t1"]
        self.waited += time.monotonic() - start
        return reply

    def say_goodbye(self, n):
        self._send({"m": BYE, "s": self.session, "n": n})
        self._ended = True
        self.close(linger=2000)

    def report_error(self, code, text):
        """Tells the coupler why this program fails, once; the others learn it from the coupler."""
        if not self._ended:
            self._ended = True
            try:
                self._patience = 0.5
                self._send({"m": ERROR, "s": self.session, "n": self.n, "code": code,
                            "text": text[:4000], "who": self.name})
            except (PeerError, zmq.ZMQError):
                pass    # the run fails already, for the reason that could not be sent
        self.close(linger=500)

    def close(self, linger=0):
        if not self._socket.closed:
            self._socket.disable_monitor()
            self._monitor.close(0)
            self._socket.close(linger)
            self._context.term()

    def __del__(self):
        if hasattr(self, "_monitor"):
            self.close()

    # ------------------------------------------------------------ sending and receiving

    def _check_step(self, n, t):
        self._stop = lambda: False      # from here on flag 1 of STATE says so
        if n != self.n or t != self.t:
            raise ValueError(f"step {n} at {t!r} s is not the agreed one: {self.n} at {self.t!r} s")

    def _check_force(self, force):
        if self._active_due:
            self._fail("E_STATE", "FORCE came after a PROBE without the ACTIVE list")
        if len(force["f"]) != self.rows:
            self._fail("E_SHAPE", f"FORCE has {len(force['f'])} rows, not {self.rows}")
        if not (force["dt"] > 0 and force["t1"] > self.t):
            self._fail("E_TIME", f"FORCE grants {force['dt']} s from {self.t} s to {force['t1']} s")

    def _send(self, message):
        frames, start = encode(message), time.monotonic()
        while True:
            if self._socket.poll(100, zmq.POLLOUT):
                self._socket.send_multipart(frames)
                return
            if self._is_lost():
                self._raise_lost()
            if time.monotonic() - start > self._patience:
                self.close()
                raise PeerError("E_TIMEOUT", f"no coupler took {LAYOUT[message['m']][0]} at "
                                             f"{self.endpoint} within {self._patience:g} s")

    def _take(self, *types, patience=None):
        """The next message, which must be one of `types`, within `patience` [s]."""
        patience, silence = patience or self._patience, 0.0
        while True:
            frames = self._receive()
            if frames is not None:
                message = self._accept(frames, types)
                if message is not None:
                    return message
                silence = 0.0       # PROGRESS: the coupler vouches for a slow peer
                continue
            if self._is_lost():
                self._raise_lost()
            if silence >= patience:
                if not self.session:
                    self.close()
                    raise PeerError("E_TIMEOUT", f"no coupler answered at {self.endpoint} within "
                                                 f"{patience:g} s; start it with this endpoint")
                self._fail("E_TIMEOUT", f"the coupler at {self.endpoint} was silent for "
                                        f"{patience:g} s")
            if self._stop():
                self._fail("E_STOP", f"the user stopped {self.name} before its first step")
            start = time.monotonic()
            self._poller.poll(1000 * min(1.0, patience - silence) + 1)
            # While this process was stopped (Ctrl-Z) nobody could be heard.
            silence += min(1.0, time.monotonic() - start)

    def _accept(self, frames, types):
        try:
            message = decode(frames)
        except PeerError as error:
            self._fail(error.code, f"the coupler's message is wrong: {error}")
        if message["m"] == ERROR:
            self._ended = True
            self.close()
            who, text = message["who"] or "coupler", message["text"]
            named = text.startswith((who + " ", who + ": "))
            raise PeerError(message["code"], text if named else f"{who}: {text}")
        if self.session and message["s"] != self.session:
            self._fail("E_SEQUENCE", f"a message of session {message['s']} came")
        if message["m"] == PROGRESS and self.session:
            return None
        if message["m"] not in types:
            self._fail("E_STATE", f"{LAYOUT[message['m']][0]} came where "
                                  f"{LAYOUT[types[0]][0]} was due")
        return message

    def _receive(self):
        try:
            return self._socket.recv_multipart(zmq.DONTWAIT)
        except zmq.Again:
            return None

    def _is_lost(self):
        while self._monitor.poll(0):
            if recv_monitor_message(self._monitor)["event"] & HANDSHAKE_FAILED and not self.session:
                self._ended = True
                self.close()
                raise PeerError("E_KEY", f"the coupler at {self.endpoint} does not take this program's "
                                         "key, or is not the one of coupler.pub; copy the keys of one "
                                         "run of `undertow keys` to all hosts" if self._has_keys else
                                f"the coupler at {self.endpoint} closes the connection at the "
                                "greeting; if it has keys (--keys), this program needs them too")
            self._lost = True
        return self._lost

    def _raise_lost(self):
        frames = self._receive()
        while frames is not None:       # the coupler may have said why before it left
            self._accept(frames, tuple(LAYOUT))
            frames = self._receive()
        self._ended = True
        self.close()
        raise PeerError("E_PEER_LOST", f"the coupler at {self.endpoint} vanished in step {self.n}; "
                                       "see coupler.log")

    def _fail(self, code, text):
        self.report_error(code, text)
        raise PeerError(code, text)
