"""A coupler that says what it is told to say, right or wrong, to one participant."""
import os
import secrets
import shlex
import signal
import subprocess
import time

import zmq
from zmq.utils.monitor import recv_monitor_message

from undertow_protocol import (ACTIVE, BYE, ERROR, FINISH, FORCE, FORCE_PROBE, HELLO, LAYOUT, MESH, MESH_ACK, PROBE,
                               PROGRESS, STATE, SURFACE, VERSION, WELCOME, PeerError, checksum, decode, encode)

from .segment import Segment

PATIENCE = 20.0         # [s] for anything the participant has to say


class Broken(Exception):
    """The participant did not do what the protocol asks; the text is one sentence."""


class Gone(Broken):
    """The connection ended."""


class NeverCame(Broken):
    """The program ended before its HELLO."""


def name_of(message):
    return LAYOUT[message["m"]][0] + (f"({message['n']})" if "n" in message else "")


class Meeting:
    """One connection with one participant, from HELLO on.

    command: starts the participant, "{endpoint}" stands for where it shall connect; None: somebody else does.
    """

    def __init__(self, endpoint, command=None, shared_memory=False, deadline=10.0, patience=PATIENCE):
        self.shared_memory, self.deadline, self.patience = shared_memory, deadline, patience
        self.session, self.n, self.t = secrets.randbits(63) | 1, 0, 0.0
        self.rows = self.step_rows = 0
        self.hello = self.segment = self.peer = None
        self.by_segment = self.lost = False
        self.headers = []                       # of all that came: (frame 0, message)
        self.process = None
        self.context = zmq.Context()
        self.socket = self.context.socket(zmq.ROUTER)
        self.socket.linger = 0
        self.socket.router_mandatory = True
        if endpoint.startswith("ipc://"):
            os.makedirs(os.path.dirname(endpoint[6:]) or ".", mode=0o700, exist_ok=True)
        before = os.umask(0o077)
        try:
            self.socket.bind(endpoint)
        finally:
            os.umask(before)
        self.endpoint = self.socket.last_endpoint.decode()
        self.monitor = self.socket.get_monitor_socket(zmq.EVENT_DISCONNECTED)
        if command:
            words = [word.replace("{endpoint}", self.endpoint) for word in command]
            self.process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                            start_new_session=True)
            self.said = shlex.join(words)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.hang_up()
        if self.process and self.process.poll() is None:
            self.process.kill()
            self.process.wait()

    def hang_up(self):
        if not self.socket.closed:
            self.socket.disable_monitor()
            self.monitor.close(0)
            self.socket.close(0)
            self.context.term()
        if self.segment:
            self.segment.close()
            self.segment = None

    # ------------------------------------------------------------ sending

    def send_frames(self, frames, by_socket=True):
        if not by_socket and self.by_segment and self.segment.write(frames):
            return
        try:
            self.socket.send_multipart([self.peer, *frames])
        except zmq.ZMQError as error:
            raise Gone(f"the connection is gone ({error})") from None
        if self.segment:
            self.segment.ring()

    def send(self, m, **keys):
        message = {"m": m, "s": self.session, "n": self.n, **keys}
        self.send_frames(encode(message), by_socket=m != FORCE)

    # ------------------------------------------------------------ receiving

    def receive(self, *wanted, seconds=None):
        """The next message but PROGRESS; Broken when it is none of `wanted` or nothing comes."""
        end = time.monotonic() + (seconds or self.patience)
        while True:
            frames = self.next_frames(end)
            if frames is None:
                raise Broken(f"no {' or '.join(LAYOUT[m][0] for m in wanted)} came within {seconds or self.patience:g} s")
            try:
                message = decode(frames)
            except PeerError as error:
                raise Broken(f"{error.code}: {error}") from None
            self.headers.append((bytes(frames[0]), message))
            if message["m"] == PROGRESS:
                continue
            if message["m"] not in wanted:
                text = f": {message['code']}: {message['text']}" if message["m"] == ERROR else ""
                raise Broken(f"{name_of(message)} came where {' or '.join(LAYOUT[m][0] for m in wanted)} was due{text}")
            return message

    def next_frames(self, end):
        """None when the time has passed."""
        while True:
            if self.segment and self.segment.joined():
                frames = self.segment.take()
                if frames is not None:
                    self.by_segment = True
                    return frames
            try:
                peer, *frames = self.socket.recv_multipart(zmq.DONTWAIT)
                self.peer = self.peer or peer
                if peer == self.peer:
                    self.by_segment = False
                    return frames
                continue
            except zmq.Again:
                pass
            if self.is_lost():
                raise Gone("the connection broke")
            if self.process and self.process.poll() is not None and not self.peer:
                raise NeverCame(f"it ended with {self.process.returncode} before its HELLO: {self.said}\n"
                                + self.process.stderr.read().decode(errors="replace").strip())
            if time.monotonic() > end:
                return None
            if self.segment and self.segment.joined():
                self.segment.wait(end - time.monotonic())
            else:
                self.socket.poll(20)

    def is_lost(self):
        while not self.lost and self.monitor.poll(0):
            self.lost = recv_monitor_message(self.monitor)["event"] == zmq.EVENT_DISCONNECTED and self.peer is not None
        if self.lost:       # what came before the end is still to be read
            return not self.socket.poll(0)
        return False

    # ------------------------------------------------------------ the life cycle

    def greet(self):
        self.hello = self.receive(HELLO)
        if self.shared_memory and "shm1" in self.hello["caps"]:
            self.segment = Segment(self.session, self.hello["name"])
        return self.hello

    def welcome(self, **other):
        caps = ["shm1"] if self.segment else []
        self.send(WELCOME, **{"v": VERSION, "caps": caps, "n0": 0, "t0": 0.0, "te": 1e3, "deadline": self.deadline,
                              "share": 0.45, "max": 512 << 20, **other})

    def particles(self):
        return self.hello["role"] == "particles"

    def meshes(self):
        """All MESHes, acknowledged; a surface's are complete with its first STATE, which is kept."""
        meshes, self.kept = [], None
        while True:
            message = self.receive(MESH) if not meshes else self.receive(MESH, STATE)
            if message["m"] == STATE:
                self.kept = message
                return meshes
            meshes.append(message)
            self.rows += len(message["x"])
            self.send(MESH_ACK, mesh=message["mesh"], rev=message["rev"], sum=checksum(message))
            if self.particles():
                self.send_surface()
                return meshes

    def send_surface(self, size=50.0):
        """A facet far below everything, and one box around everything."""
        x = [[-1, -1, -size], [1, -1, -size], [1, 1, -size], [-1, 1, -size]]
        self.send(SURFACE, range=0.0, x=x, quad=[[0, 1, 2, 3]], boxes=[[-size] * 3 + [size] * 3])

    def prepare(self):
        self.greet()
        self.welcome()
        return self.meshes()

    def state(self, probe=False):
        """STATE or PROBE of the running step."""
        if getattr(self, "kept", None):
            message, self.kept = self.kept, None
        else:
            message = self.receive(PROBE if probe else STATE)
        self.step_rows = len(message["x"])
        return message

    def answer(self, message, active=None, dt=None, probe=False, f=None):
        """ACTIVE after a PROBE, then FORCE: half the step that was offered, no force. Returns dt."""
        dt = dt or 0.5 * min(message["dl"], 1.0)
        rows = self.step_rows
        if message["m"] == PROBE:
            chosen = list(range(rows) if active is None else active)
            self.send(ACTIVE, row=chosen)
            rows = self.rows = len(chosen)
            self.by_segment = False
        if probe:
            self.send_surface()
            self.by_segment = False
        if self.segment and self.segment.joined():
            self.segment.reserve(rows)
        self.send(FORCE, dt=dt, t1=self.t + dt, fl=FORCE_PROBE if probe else 0, lim="conform",
                  f=[[0.0] * 3] * rows if f is None else f)
        self.n, self.t = self.n + 1, self.t + dt
        return dt

    def steps(self, count):
        """Ordinary steps; returns the message of the next one, unanswered."""
        probe = self.particles()
        for _ in range(count):
            self.answer(self.state(probe and self.n == 0))
        return self.state(probe and self.n == 0)

    def finish(self, reason="done"):
        self.send(FINISH, reason=reason)
        bye = self.receive(BYE)
        return bye

    # ------------------------------------------------------------ how it ends

    def exit_code(self, seconds):
        """Of the participant's process; None when it still runs, or is not ours."""
        if not self.process:
            return None
        try:
            return self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            return None

    def interrupt(self):
        self.process.send_signal(signal.SIGINT)
