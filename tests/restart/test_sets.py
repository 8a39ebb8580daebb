"""Sets of checkpoints: when they are written, what is refused by name, what goes, what a full disk
leaves. With fem_solver alone, which is quick; test_trio.py has the three programs."""
import hashlib
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import time
import unittest

import h5py

from scenes import ENVIRONMENT, HERE, TOP, Restart, slow_fields

LONGER = ("--set", "time.end=0.04", "--set", "output.fields_every=0.005", "--set",
          "output.history_every=1e-4")


class Sets(Restart):
    program = "fem_solver"

    def cut(self, *options, every=5e-4):
        return self.new("structure.toml").go("--set", f"checkpoint.every={every}", *options)

    def wait(self, holds):
        end = time.monotonic() + 120
        while not holds():
            self.assertLess(time.monotonic(), end, "waited for 120 s")
            time.sleep(0.005)

    def refused(self, run, folder, *says, options=()):
        run.resume(folder, *options, code=2)
        for words in says:
            self.assertIn(words, run.said)

    def edit(self, folder, change):
        """change(file) in the program's file of the set, and a manifest that fits."""
        with h5py.File(folder / "fem.h5", "r+") as file:
            change(file)
        data = (folder / "fem.h5").read_bytes()
        manifest = json.loads((folder / "manifest.json").read_text())
        manifest["files"][0].update(bytes=len(data), sha256=hashlib.sha256(data).hexdigest())
        (folder / "manifest.json").write_text(json.dumps(manifest))

    # ------------------------------------------------------------ when

    def test_without_the_table_there_are_none(self):
        self.assertFalse((self.new("structure.toml").go().out / "checkpoints").exists())

    def test_the_last_two_stay(self):
        steps = [int(folder.name[5:]) for folder in self.cut().sets()]
        self.assertEqual(len(steps), 2)
        self.assertEqual([folder.name for folder in self.cut("--set", "checkpoint.keep=3").sets()][1:],
                         [f"step_{step:09d}" for step in steps])

    def test_by_the_wall_clock(self):
        run = self.new("structure.toml", *LONGER).go("--set", "checkpoint.every_wall=0.01",
                                                     "--set", "checkpoint.keep=100",
                                                     environment=slow_fields("fem"))
        self.assertGreater(len(run.sets()), 2)

    def test_at_the_end_to_go_on_beyond_it(self):
        whole = self.new("structure.toml", "--set", "time.end=5e-3").go()
        first = self.new("structure.toml").go("--set", "checkpoint.at_end=true")
        (last,) = first.sets()
        first.resume(last, "--set", "time.end=5e-3", "--set", "output.history_every=2e-5")
        # the step that lands on the first end lands on an output as well
        whole.must_equal(first)

    def test_sigterm_leaves_one_and_undertow_resume_goes_on(self):
        whole, run = self.new("structure.toml", *LONGER), self.new("structure.toml", *LONGER)
        self.tool("run", whole.case, "--out", whole.out, "--threads", 1, *LONGER)
        command = self.tool_command("run", run.case, "--out", run.out, "--threads", 1, *LONGER,
                                    "--set", "checkpoint.every=10")
        for number in (signal.SIGTERM, signal.SIGINT):
            tool = subprocess.Popen(command, env={**ENVIRONMENT, **slow_fields("fem")},
                                    stdout=subprocess.PIPE, text=True)
            fields = run.out / "fem.xdmf"
            before = fields.stat().st_size if run.sets() else 0
            self.wait(lambda: fields.exists() and fields.stat().st_size > before)
            tool.send_signal(number)
            said = tool.communicate()[0]
            self.assertEqual(tool.returncode, 130, said)
            self.assertIn("undertow resume", said)
            command = self.tool_command("resume", run.out)
        self.assertEqual(len(run.sets()), 2)
        self.tool("resume", run.out, "--threads", 2)
        whole.must_equal(run)
        self.assertEqual(len(json.loads((run.out / "run.json").read_text())["resumed"]), 2)

    def test_killed_at_a_row_it_goes_on_as_if_nothing_had_been(self):
        whole = self.new("structure.toml", *LONGER).go()
        run = self.new("structure.toml", *LONGER)
        killed = subprocess.Popen(run.command("--set", "checkpoint.every=2e-3"),
                                  env={**ENVIRONMENT, **slow_fields("fem")}, stderr=subprocess.DEVNULL)
        self.wait(lambda: len(run.sets()) >= 2)
        killed.kill()
        self.assertEqual(killed.wait(), -signal.SIGKILL)
        run.resume(run.sets()[-1])
        whole.must_equal(run)

    def test_the_status_tells_the_age_of_the_set_that_a_run_was_resumed_from(self):
        run = self.cut()
        folder = run.sets()[-1]
        an_hour_ago = int(time.time()) - 3600
        os.utime(folder / "manifest.json", (an_hour_ago, an_hour_ago))
        run.resume(folder)
        kept = json.loads((run.out / "status.json").read_text())["checkpoint"]
        self.assertEqual(kept["folder"], f"checkpoints/{folder.name}")
        self.assertEqual(kept["written_at"], an_hour_ago)

    # ------------------------------------------------------------ what is refused

    def test_an_edited_case(self):
        run = self.cut()
        folder = run.sets()[-1]
        self.refused(run, folder, "fem.damping_alpha is 21, but", "was written with 20",
                     options=("--set", "fem.damping_alpha=21"))
        self.refused(run, folder, "fem.part", options=("--with", "b_bar"))
        self.refused(run, folder, "fem.cfl is 0.8, but", "was written without it",
                     options=("--set", "fem.cfl=0.8"))
        self.refused(run, folder, "time.max_step", options=("--set", "time.max_step=1"))

    def test_another_mesh(self):
        run = self.new("foundation.toml")
        folder = run.out.parent / "case"
        shutil.copytree(TOP / "cases" / "bucket" / "mesh", folder)
        text = (HERE / "foundation.toml").read_text().replace("../../cases/bucket/mesh/", "")
        run.case = folder / "foundation.toml"
        run.case.write_text(text)
        run.go("--set", "checkpoint.every=5e-3", "--set", "time.end=0.008")
        # one corner of the ground a micrometer elsewhere
        mesh = folder / "quick.msh"
        lines = mesh.read_text().splitlines()
        at = next(k for k in range(lines.index("$Nodes"), len(lines))
                  if re.fullmatch(r"(-?[\d.e+-]+ ){2}-?[\d.e+-]+", lines[k]))
        x, y, z = lines[at].split()
        lines[at] = f"{float(x) + 1e-6} {y} {z}"
        mesh.write_text("\n".join(lines) + "\n")
        self.refused(run, run.sets()[-1], "fem.mesh", "quick.msh", "content")

    def test_files_of_two_sets(self):
        run = self.cut()
        old, new = run.sets()
        shutil.copy(old / "fem.h5", new / "fem.h5")
        self.refused(run, new, "fem.h5 is not the file that the manifest", "another set")
        # and with a manifest that was made to fit
        manifest = json.loads((new / "manifest.json").read_text())
        manifest["files"] = json.loads((old / "manifest.json").read_text())["files"]
        (new / "manifest.json").write_text(json.dumps(manifest))
        self.refused(run, new, "of step", "different sets")

    def test_a_damaged_file(self):
        run = self.cut()
        folder = run.sets()[-1]
        data = bytearray((folder / "fem.h5").read_bytes())
        data[len(data) // 2] ^= 1
        (folder / "fem.h5").write_bytes(data)
        self.refused(run, folder, "fem.h5 is not the file", "SHA-256")
        (folder / "fem.h5").unlink()
        self.refused(run, folder, "fem.h5 is missing")

    def test_a_set_without_a_manifest(self):
        run = self.cut()
        folder = run.sets()[-1]
        (folder / "manifest.json").unlink()
        self.refused(run, folder, "holds no manifest.json")
        (folder / "manifest.json").write_text('{"format": 1')
        self.refused(run, folder, "manifest.json is damaged")

    def test_results_that_are_not_those_of_the_run(self):
        run = self.cut()
        folder = run.sets()[-1]
        (run.out / "fem.history.csv").write_text("t\n")
        self.refused(run, folder, "fem.history.csv has 2 bytes")
        (run.out / "fem.vtkhdf").unlink()
        self.refused(run, folder, "fem.vtkhdf")

    def test_a_file_that_lacks_something(self):
        run = self.cut()
        folder = run.sets()[-1]
        self.edit(folder, lambda file: file.pop("structure/nodes/v"))
        self.refused(run, folder, "lacks /structure/nodes/v")

    def test_elements_in_another_order(self):
        """Of a large mesh: those of a small one are stored as the mesh has them."""
        small = self.cut()
        folder = small.sets()[-1]
        with h5py.File(folder / "fem.h5") as file:
            self.assertNotIn("order", file["structure/elements/0"])
        many = ("--with", "many", "--set", "output.fields_every=4e-4")
        for variant in ((), ("--with", "tetrahedra"), ("--with", "b_bar")):
            run = self.new("structure.toml", *many, *variant).go("--set", "checkpoint.every=2e-4")
            folder = run.sets()[-1]

            def other(file):
                file["structure/elements/0/order"][...] ^= 1

            self.edit(folder, other)
            self.refused(run, folder, "order", "resume with the version that wrote it")
            self.edit(folder, lambda file: file.pop("structure/elements/0/order"))   # before there was one
            self.refused(run, folder, "lacks /structure/elements/0/order", "another version")

    def test_the_tool_says_what_there_is(self):
        run = self.new("structure.toml", "--set", "checkpoint.every=1e-3")
        self.tool("run", run.case, *run.options, "--out", run.out)
        self.assertIn(run.sets()[0].name, self.tool("resume", run.out, "--from", "7", code=2))
        self.assertIn("fem.cfl is 0.8", self.tool("resume", run.out, "--set", "fem.cfl=0.8", code=2))

    # ------------------------------------------------------------ a full disk

    def test_a_full_disk_leaves_the_last_one_whole(self):
        options = ("--with", "many", "--with", "b_bar", "--set", "output.fields_every=4e-4")
        whole = self.new("structure.toml", *options).go()
        run = self.new("structure.toml", *options).go("--set", "checkpoint.every=1e-4",
                                                      "--set", "checkpoint.keep=100")
        kept, *later = run.sets()
        for folder in later:
            shutil.rmtree(folder)
        room = int(0.8 * (kept / "fem.h5").stat().st_size)    # more than any other file needs

        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (room, room))

        run.resume(kept, "--set", "checkpoint.every=1e-4", code=2, before=limit)
        self.assertIn("fem.h5 could not be written", run.said)
        self.assertIn("the sets before it are whole", run.said)
        self.assertEqual(run.sets(), [kept])
        self.assertEqual(list(run.out.glob("checkpoints/*/*.tmp")), [])
        run.resume(kept)
        whole.must_equal(run)


if __name__ == "__main__":
    unittest.main()
