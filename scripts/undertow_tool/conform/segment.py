"""The coupler's end of the shared-memory plane "shm1", as docs/protocol.md has it."""
import ctypes
import fcntl
import mmap
import os
import struct
import time

PAGE, LINE = 4096, 64
UP, DOWN = 64, 256                          # byte of each direction's words
BELL, MESSAGE, BY_SOCKET, HEADER, ARRAYS, SIZES = 0, 4, 8, 12, 16, 24
FUTEX, FUTEX_WAIT, FUTEX_WAKE = 202, 0, 1   # x86-64
EVERYBODY = 0x7fffffff

_libc = ctypes.CDLL(None, use_errno=True)


class _Timespec(ctypes.Structure):
    _fields_ = [("seconds", ctypes.c_long), ("nanoseconds", ctypes.c_long)]


def aligned(size):
    return (size + LINE - 1) // LINE * LINE


class Segment:
    def __init__(self, session, name):
        self.path = f"/dev/shm/undertow-{session:016x}-{name}"
        self.file = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
        fcntl.flock(self.file, fcntl.LOCK_EX)      # a coupler that starts removes what nobody holds
        os.posix_fallocate(self.file, 0, PAGE)
        self.map = mmap.mmap(self.file, PAGE)
        self.words = (ctypes.c_char * PAGE).from_buffer(self.map)
        self.base = ctypes.addressof(self.words)
        struct.pack_into("<8sQ", self.words, 0, b"UTOWshm1", session)
        self.up = self.down = 0
        self.blocks = None
        self.read = self.written = self.heard = 0

    def word(self, place):
        return struct.unpack_from("<I", self.words, place)[0]

    def put(self, place, value):
        struct.pack_into("<I", self.words, place, value)

    def joined(self):
        return self.word(16) != 0

    def close(self):
        if os.path.exists(self.path):
            os.unlink(self.path)
        os.close(self.file)

    def reserve(self, rows):
        """Room for a STATE and a FORCE of so many rows."""
        up = aligned(2048) + 2 * aligned(24 * rows)
        down = aligned(2048) + aligned(24 * rows) + LINE
        if up <= self.up and down <= self.down:
            return
        self.up, self.down = (-(-max(size, now) // PAGE) * PAGE for size, now in ((up, self.up), (down, self.down)))
        os.posix_fallocate(self.file, 0, PAGE + self.up + self.down)
        self.blocks = mmap.mmap(self.file, self.up + self.down, offset=PAGE)
        struct.pack_into("<QQ", self.words, 24, self.up, self.down)
        self.put(20, self.word(20) + 1)

    def wake(self):
        self.put(DOWN + BELL, (self.word(DOWN + BELL) + 1) & 0xffffffff)
        _libc.syscall(FUTEX, ctypes.c_void_p(self.base + DOWN + BELL), FUTEX_WAKE, EVERYBODY, None, None, 0)

    def write(self, frames):
        """False when the block is too small."""
        if sum(aligned(len(frame)) for frame in frames) > self.down or len(frames) > 17:
            return False
        place = self.up
        for frame in frames:
            self.blocks[place:place + len(frame)] = bytes(frame)
            place += aligned(len(frame))
        struct.pack_into("<II", self.words, DOWN + HEADER, len(frames[0]), len(frames) - 1)
        for number, frame in enumerate(frames[1:]):
            struct.pack_into("<Q", self.words, DOWN + SIZES + 8 * number, len(frame))
        self.written += 1
        self.put(DOWN + MESSAGE, self.written)
        self.wake()
        return True

    def ring(self):
        """For a message that went by the socket."""
        self.put(DOWN + BY_SOCKET, self.word(DOWN + BY_SOCKET) + 1)
        self.wake()

    def take(self):
        """The frames of a message, or None."""
        if self.word(UP + MESSAGE) == self.read:
            return None
        self.read = self.word(UP + MESSAGE)
        header, arrays = struct.unpack_from("<II", self.words, UP + HEADER)
        sizes = [header, *struct.unpack_from(f"<{arrays}Q", self.words, UP + SIZES)]
        frames, place = [], 0
        for size in sizes:
            frames.append(self.blocks[place:place + size])
            place += aligned(size)
        return frames

    def wait(self, seconds):
        """Until the participant rings, at most `seconds` and at most 20 ms."""
        bell = self.word(UP + BELL)
        if self.word(UP + MESSAGE) != self.read:
            return
        span = _Timespec(0, int(1e9 * min(max(seconds, 0), 0.02)))
        if _libc.syscall(FUTEX, ctypes.c_void_p(self.base + UP + BELL), FUTEX_WAIT, bell, ctypes.byref(span), None, 0):
            time.sleep(0)       # rung in between, or the time has passed
