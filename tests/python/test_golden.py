"""The bytes of protocol version 1 in Python: the same golden vectors that bind the C++ side."""
import pathlib
import sys
import unittest

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
import undertow_protocol as protocol  # noqa: E402

GOLDEN = ROOT / "tests" / "golden" / "protocol_v1"


def read(path):
    """The frames of a .hex file, and the code behind '# expect'."""
    frames, code = [], None
    for line in path.read_text(encoding="ascii").splitlines():
        if line.startswith("# expect "):
            code = line.split()[2]
        elif not line.startswith("#"):
            frames.append(b"" if line == "-" else bytes.fromhex(line))
    return frames, code


class Golden(unittest.TestCase):
    def test_every_message_decodes_and_encodes_to_the_same_bytes(self):
        types = set()
        for path in sorted(GOLDEN.glob("[!f]*.hex")) + sorted(GOLDEN.glob("f[!a]*.hex")):
            with self.subTest(path.name):
                frames, _ = read(path)
                message = protocol.decode(frames)
                self.assertEqual(protocol.encode(message), frames)
                types.add(message["m"])
        self.assertEqual(types, set(protocol.LAYOUT))

    def test_every_fault_is_refused_with_its_code(self):
        paths = sorted(GOLDEN.glob("fault_*.hex"))
        self.assertGreaterEqual(len(paths), 15)
        for path in paths:
            with self.subTest(path.name):
                frames, code = read(path)
                with self.assertRaises(protocol.PeerError) as caught:
                    protocol.decode(frames)
                self.assertEqual(caught.exception.code, code)

    def test_messages_written_here_have_the_golden_bytes(self):
        step = {"s": 0x1234, "n": 7}
        written = {
            "hello": {"m": protocol.HELLO, "p": "undertow", "v": [1, 0], "name": "fem",
                      "role": "surface", "caps": ["checkpoint"], "sw": "demo-fem 0.1",
                      "units": "SI"},
            "hello_case": {"m": protocol.HELLO, "p": "undertow", "v": [1, 1], "name": "fem",
                           "role": "surface", "caps": ["checkpoint"], "sw": "demo-fem 0.1", "units": "SI",
                           "case": ['case.name = "dam"', "time.max_step = 0.0001",
                                    "fem.mesh = #a5b1e6c9f0d24738"]},
            "state": {"m": protocol.STATE, **step, "t": 1.25e-5, "dl": 2e-6, "rev": 0,
                      "lim": "hexahedron 3", "fl": 0, "reach": 0, "work": 56, "wait": 0.001,
                      "x": [[0, 0, 0], [1, 0, -0.5]], "v": [[0, 0, 0], [0.25, 0, 1e-3]]},
            "bye": {"m": protocol.BYE, **step},
        }
        for name, message in written.items():
            with self.subTest(name):
                self.assertEqual(protocol.encode(message), read(GOLDEN / (name + ".hex"))[0])

    def test_the_checksum_of_a_mesh_is_that_of_its_ack(self):
        mesh = protocol.decode(read(GOLDEN / "mesh_surface.hex")[0])
        ack = protocol.decode(read(GOLDEN / "mesh_ack.hex")[0])
        self.assertEqual(protocol.checksum(mesh), ack["sum"])

    def test_keys_in_another_order_and_unknown_keys_are_accepted(self):
        import msgpack
        raw = msgpack.packb({"future": [1], "a": [], "n": 3, "s": 9, "m": protocol.BYE})
        self.assertEqual(protocol.decode([raw]), {"m": protocol.BYE, "s": 9, "n": 3})

    def test_mutated_headers_end_in_a_message_or_a_peer_error(self):
        random = np.random.default_rng(7)
        seeds = [read(path)[0] for path in sorted(GOLDEN.glob("*.hex"))]
        n_refused = 0
        for _ in range(3000):
            frames = list(seeds[random.integers(len(seeds))])
            header = bytearray(frames[0])
            for _ in range(random.integers(1, 4)):
                place = random.integers(len(header) + 1)
                header[place:place + random.integers(2)] = random.bytes(random.integers(3))
            frames[0] = bytes(header)
            try:
                protocol.decode(frames)
            except protocol.PeerError:
                n_refused += 1
        self.assertGreater(n_refused, 1000)


if __name__ == "__main__":
    unittest.main()
