"""docs/protocol.md is what the code does: key tables, worked bytes, and the skeleton."""
import pathlib
import re
import subprocess
import tempfile
import unittest

import numpy as np

import test_participant
from test_golden import GOLDEN, ROOT, protocol, read

DOC = (ROOT / "docs" / "protocol.md").read_text(encoding="utf-8")
KINDS = {"int": "i", "number": "f", "text": "t", "texts": "T", "texts, optional": "T?", "[int, int]": "V"}


class Tables(unittest.TestCase):
    def test_every_message_has_its_keys_and_arrays_in_the_order_of_the_bytes(self):
        sections = re.findall(r"^### (\w+) \((\d+)\).*?\n(.*?)(?=^##)", DOC, re.M | re.S)
        self.assertEqual({int(m) for _, m, _ in sections}, set(protocol.LAYOUT))
        for name, m, text in sections:
            with self.subTest(name):
                expected_name, keys, arrays = protocol.LAYOUT[int(m)]
                self.assertEqual(name, expected_name)
                rows = re.findall(r"^\| `(\w+)` \| ([^|]+?) \|", text, re.M)
                found_keys, found_arrays = [], []
                for key, kind in rows:
                    array = re.match(r"(\w\d) \(\w(?:, (\d))?\)", kind)
                    if array:
                        found_arrays.append((key, array[1], int(array[2] or 1)))
                    else:
                        self.assertEqual(found_arrays, [], "keys stand before arrays")
                        kind = re.sub(r" \[(s|m|byte)\]$", "", kind)
                        found_keys.append((key, KINDS[kind]))
                self.assertEqual(found_keys, keys)
                self.assertEqual(found_arrays, arrays)

    def test_the_error_codes_are_those_of_the_headers(self):
        header = (ROOT / "protocol/wire/messages.hpp").read_text(encoding="ascii")
        known = set(re.findall(r"\bE_[A-Z_]+", header))
        self.assertEqual(set(re.findall(r"^\| (E_[A-Z_]+) \|", DOC, re.M)), known)


class Bytes(unittest.TestCase):
    def test_the_worked_bytes_are_the_golden_ones(self):
        for name in ("state", "force", "error"):
            for frame in read(GOLDEN / (name + ".hex"))[0]:
                self.assertIn("\n" + frame.hex() + "\n", DOC)

    def test_the_bytes_explained_one_by_one_are_the_whole_header(self):
        section = DOC[DOC.index("## Worked bytes"):]
        rows = re.findall(r"^\| `([0-9a-f ]+)` \|", section, re.M)
        self.assertEqual("".join(rows).replace(" ", ""),
                         read(GOLDEN / "state.hex")[0][0].hex())


class Skeleton(unittest.TestCase):
    def test_the_skeleton_runs_a_session(self):
        code = re.search(r"```python\n(.*?)```", DOC, re.S)[1]
        with tempfile.TemporaryDirectory() as folder:
            endpoint = f"ipc://{folder}/coupler.sock"
            coupler = test_participant.Coupler(endpoint)
            process = subprocess.Popen(["/usr/bin/python3", "-c", code, endpoint])
            try:
                coupler.welcome()
                coupler.acknowledge()
                t, largest = 0.0, 0.0
                for n in range(200):
                    state = coupler.receive(protocol.STATE)
                    self.assertEqual((state["n"], state["t"]), (n, t))
                    largest = max(largest, state["x"][0, 2])
                    t1 = t + 1e-3
                    coupler.force(n, 1e-3, t1, np.tile([0.0, 0.0, 2.0], (4, 1)))
                    t = t1
                coupler.receive(protocol.STATE)
                coupler.send(protocol.FINISH, n=200, reason="done")
                coupler.receive(protocol.BYE)
                self.assertEqual(process.wait(10), 0)
                # A step load overshoots to twice F/k; the peak is sampled 63 times per period.
                self.assertAlmostEqual(largest / (2 * 2.0 / 2e4), 1, delta=2e-3)
            finally:
                process.kill()
                process.wait()
                coupler.close()


if __name__ == "__main__":
    unittest.main()
