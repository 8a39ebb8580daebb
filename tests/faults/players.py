"""Ends of the link that a test plays by hand: a surface that can send any bytes, and a coupler."""
import sys

import numpy as np
from harness import TOP

sys.path.insert(0, str(TOP / "scripts"))
import undertow_protocol as protocol  # noqa: E402

SQUARE = {"mesh": "plate", "groups": ["plate"], "x": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
          "mass": [1, 1, 1, 1], "quad": [[0, 1, 2, 3]], "group": [0]}
DT = 1e-4       # [s] offered


class Surface:
    """A plate at rest that keeps to the protocol until it is told to send something else."""

    def __init__(self, endpoint, **mesh):
        self.link = protocol.Participant(endpoint, "fem", "surface", "by hand", join_timeout=60)
        self.link.announce(**{**SQUARE, **mesh})
        self.x = np.array(SQUARE["x"], float)
        self.n, self.t = self.link.welcome["n0"], self.link.welcome["t0"]

    def step(self, n_steps):
        for _ in range(n_steps):
            self.link.send_state(self.n, self.t, DT, self.x, np.zeros((4, 3)), "by hand")
            force = self.link.wait_reply().force
            self.n, self.t = self.n + 1, force["t1"]

    def state(self, **keys):
        """The next STATE, with whatever shall be wrong in it."""
        return {"m": protocol.STATE, "s": self.link.session, "n": self.n, "t": self.t, "dl": DT,
                "rev": 0, "lim": "by hand", "fl": 0, "reach": 0.0, "work": 0.0, "wait": 0.0,
                "x": self.x, "v": np.zeros((4, 3)), **keys}

    def send(self, frames):
        if isinstance(frames, dict):
            frames = protocol.encode(frames)
        self.link._socket.send_multipart(frames, copy=False)

    def answer(self):
        """The ERROR that comes back, as a PeerError; a FORCE is none."""
        try:
            self.link._take(protocol.FORCE)
        except protocol.PeerError as error:
            return error
        return None

    def close(self):
        self.link.close()


class Coupler:
    """One participant's coupler, step by step."""

    def __init__(self, endpoint):
        import zmq
        self.context = zmq.Context()
        self.socket = self.context.socket(zmq.ROUTER)
        self.socket.setsockopt(zmq.LINGER, 500)
        self.socket.setsockopt(zmq.RCVTIMEO, 60000)
        self.socket.bind(endpoint)
        self.session = 77

    def receive(self, m):
        frames = self.socket.recv_multipart()
        self.peer = frames[0]
        message = protocol.decode(frames[1:])
        assert message["m"] == m, f"{message} came, type {m} was due"
        return message

    def send(self, m, **keys):
        self.socket.send_multipart([self.peer] + protocol.encode({"m": m, "s": self.session, **keys}))

    def welcome_surface(self, **keys):
        """HELLO to the first STATE; returns the mesh."""
        self.receive(protocol.HELLO)
        self.send(protocol.WELCOME, **{"v": [1, 0], "caps": [], "n0": 0, "t0": 0.0, "te": 1.0,
                                       "deadline": 30.0, "share": 0.45, "max": 1 << 29, **keys})
        mesh = self.receive(protocol.MESH)
        self.send(protocol.MESH_ACK, mesh=mesh["mesh"], rev=0, sum=protocol.checksum(mesh))
        self.receive(protocol.STATE)
        return mesh

    def close(self):
        self.socket.close()
        self.context.term()
