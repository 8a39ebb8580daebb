"""A recorded session (protocol/wire/recording.hpp) played to a participant by the wire."""
import struct

import msgpack
import numpy as np

from undertow_protocol import BYE, HELLO, LAYOUT, PROGRESS, encode

from ..errors import UserError
from .coupler import Broken, name_of

MAGIC = b"UTOWrec1"
BY_COUPLER, BY_PARTICIPANT = 0, 1
MULTIPLIER = 0x9e3779b97f4a7c15


def read_recording(path):
    """(speaker, frames) one after the other; of the participant the header and the fingerprint."""
    with open(path, "rb") as file:
        if file.read(8) != MAGIC:
            raise UserError(f"{path} is no recording: make one with --record.")
        while head := file.read(16):
            speaker, header, arrays = struct.unpack("<IIQ", head)
            sizes = struct.unpack(f"<{arrays}Q", file.read(8 * arrays))
            yield speaker, [file.read(size) for size in (header, *sizes)]


def fingerprint(arrays):
    """Horner's rule over 64-bit words modulo 2^64, see wire/recording.hpp."""
    padded = b"".join(bytes(array) + bytes(-len(array) % 8) for array in arrays)
    words = np.frombuffer(padded, "<u8")
    powers = np.full(len(words), MULTIPLIER, "u8")
    powers[:1] = 1
    with np.errstate(over="ignore"):
        return int((words * np.multiply.accumulate(powers)[::-1]).sum(dtype="u8"))


def keys_of(header):
    keys = msgpack.unpackb(header)
    return {key: value for key, value in keys.items() if key not in ("wait", "sha")}     # they follow the clock


def play(meeting, path):
    """Plays the whole recording. Raises Broken when the participant leaves its order; returns a remark:
    whether it said the same in every bit."""
    first, count, different = None, 0, 0
    for speaker, frames in read_recording(path):
        kind = keys_of(frames[0])["m"]
        if speaker == BY_COUPLER:
            if "caps" in keys_of(frames[0]):        # WELCOME: over the socket, whatever it was
                keys = msgpack.unpackb(frames[0])
                frames = [msgpack.packb({**keys, "caps": [cap for cap in keys["caps"] if cap != "shm1"]})]
            meeting.send_frames(frames)
            continue
        message = meeting.receive(*[m for m in LAYOUT if m != PROGRESS])
        if message["m"] != kind:
            raise Broken(f"{name_of(message)} came where the recording has {LAYOUT[kind][0]}")
        if kind in (HELLO, BYE):
            continue
        count += 1
        said = encode(message)
        if keys_of(said[0]) != keys_of(frames[0]) or fingerprint(said[1:]) != int.from_bytes(frames[1], "little"):
            different += 1
            first = first or name_of(message)
    if first:
        return f"{different} of {count} messages differ from the recorded ones, the first is {first}"
    return f"{count} messages, all as recorded in every bit"
