"""docs/case_file.md is what the programs read: the keys of every table, their defaults, and the first case."""
import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
DOC = (ROOT / "docs" / "case_file.md").read_text(encoding="utf-8")
TOOL = pathlib.Path(os.environ.get("UNDERTOW_BUILD", ROOT / "build")).absolute() / "bin" / "undertow_case"

# One case that has every table, with no more than it needs, so that the rest are defaults. What a gauge may have depends
# on its kind: hence two of them.
CASE = """
case.name = "all"
time.end = 1
start = {}
output = {}
checkpoint = {}
[sph]
spacing = 0.1
domain = { min = [0, 0, 0], max = [1, 1, 1] }
fluid = [{ name = "f", density = 1000 }]
fill = [{ fluid = "f", box = { min = [0, 0, 0], max = [1, 1, 1] } }]
obstacle = [{ name = "o", box = { min = [0, 0, 0], max = [1, 1, 1] } }]
plane = [{ name = "p", point = [0, 0, 0], normal = [0, 0, 1] }]
body = [{ name = "b", box = { min = [0, 0, 0], max = [1, 1, 1] } }]
gauge = [
    { name = "flux", kind = "flux", box = { min = [0, 0, 0], max = [0, 1, 1] } },
    { name = "force", kind = "force", wall = "p" },
]
inflow = [{ name = "i", fluid = "f", velocity = 1, box = { min = [0, 0, 0], max = [0, 1, 1] }, normal = [1, 0, 0] }]
outflow = [{ name = "o", box = { min = [1, 0, 0], max = [1, 1, 1] }, normal = [-1, 0, 0] }]
absorbing = [{ name = "a", box = { min = [0, 0, 0], max = [1, 1, 1] }, direction = [1, 0, 0] }]
[fem]
block = { box = { min = [0, 0, 0], max = [1, 1, 1] }, divisions = [1, 1, 1] }
material = [{ name = "m", density = 1000, young_modulus = 1e6, poisson_ratio = 0.3 }]
part = [{ set = "block", material = "m" }]
support = [{ set = "zmin", fix = ["x"] }]
mass = [{ set = "zmin", mass = 1 }]
pressure = [{ set = "zmax", value = 1 }]
traction = [{ set = "zmax", value = [1, 0, 0] }]
surface = [{ name = "s", set = "xmin" }]
water = { level = 0 }
geostatic = { set = "block", surface = 0 }
settle = {}
absorbing = [{ set = "xmin" }]
rigid = [{ name = "r", set = "block" }]
motion = [{ name = "m", set = "zmin", angle = "0*t" }]
initial_velocity = [{ set = "zmin", velocity = [0, 0, 0] }]
contact = [{ name = "c", nodes = "xmin", surface = "xmax", gap = 1e-3 }]
probe = [{ name = "p", point = [0, 0, 0] }]
history = [{ name = "h", kind = "point", point = [0, 0, 0] }]
[coupling]
patch = [{ name = "p", area = 1, box = { min = [0, 0, 0], max = [1, 1, 1] } }]
"""
# Keys that are read only beside others, or in the place of others.
ALTERNATIVES = {"fem.block": {"corners"}}


def tables():
    """{"sph.fluid": [(keys, default)]} of the page."""
    found = {}
    for name, text in re.findall(r"^### \[+([\w.]+)\]+\n(.*?)(?=^##|\Z)", DOC, re.M | re.S):
        rows = re.findall(r"^\| (`[^|]*) \|[^|]*\| ?([^|]*?) ?\|", text, re.M)
        if rows:
            found[name] = [(re.findall(r"`(\w+)`", keys), default) for keys, default in rows]
    return found


class CaseFile(unittest.TestCase):
    def setUp(self):
        if not TOOL.exists():
            self.skipTest(f"{TOOL} is not built")
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name) / "case.toml"
        self.path.write_text(CASE)

    def tearDown(self):
        self.folder.cleanup()

    def read(self, *options, path=None):
        return subprocess.run([TOOL, path or self.path, *options], capture_output=True, text=True)

    def known_keys(self, place):
        """What the reader takes there: its own words about a key that it does not know."""
        said = self.read("--set", f"{place}.zzzzzzzz=1").stderr
        match = re.search(r"is not a key of .*?: allowed are ([\w, ]+)", said)
        self.assertTrue(match, said)
        return set(match[1].split(", "))

    def test_the_case_with_every_table_is_valid(self):
        ran = self.read()
        self.assertEqual(ran.returncode, 0, ran.stderr)

    def test_every_table_of_the_reader_is_on_the_page_and_no_other(self):
        documented = set(tables())
        expected = {"case", "time", "start", "output", "checkpoint", "sph", "fem", "coupling"}
        case = json.loads(self.read().stdout)
        for top in ("sph", "fem", "coupling"):
            expected |= {f"{top}.{key}" for key in self.known_keys(top)
                         if isinstance(case[top].get(key), list) and any(isinstance(x, dict) for x in case[top][key])
                         or key in ("block", "water", "geostatic", "settle") and top == "fem"}
        self.assertEqual(documented, expected)

    def test_every_key_of_the_reader_is_on_the_page_and_no_other(self):
        case = json.loads(self.read().stdout)
        for name, rows in tables().items():
            with self.subTest(name):
                top, _, key = name.partition(".")
                entries = case[top].get(key) if key else None
                places = [f"{name}.{k}" for k in range(len(entries))] if isinstance(entries, list) else [name]
                known = set().union(*(self.known_keys(place) for place in places)) | ALTERNATIVES.get(name, set())
                documented = [key for keys, _ in rows for key in keys]
                self.assertEqual(sorted(documented), sorted(known))

    def test_numbers_words_and_flags_among_the_defaults_are_those_of_the_reader(self):
        case = json.loads(self.read().stdout)
        compared = 0
        for name, rows in tables().items():
            top, _, key = name.partition(".")
            table = case[top].get(key) if key else case[top]
            table = table[0] if isinstance(table, list) else table
            for keys, default in rows:
                if len(keys) != 1 or keys[0] not in table or not re.fullmatch(r'[-\d.e]+|"\w+"|true|false|\[[-\d., ]+\]', default):
                    continue
                with self.subTest(f"{name}.{keys[0]}"):
                    self.assertEqual(table[keys[0]], json.loads(default))
                    compared += 1
        self.assertGreater(compared, 60)

    def test_the_first_case_is_valid_and_coupled(self):
        code = re.search(r"```toml\n(.*?)```", DOC, re.S)[1]
        path = self.path.with_name("first.toml")
        path.write_text(code)
        ran = self.read(path=path)
        self.assertEqual(ran.returncode, 0, ran.stderr)
        self.assertTrue(json.loads(ran.stdout)["coupled"])


if __name__ == "__main__":
    unittest.main()
