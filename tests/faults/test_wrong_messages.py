"""Rows 5 to 10, 12, 13 and 22 of docs/fault_matrix.md: what a participant must not send, sent to the
coupler's program in mid-run. The coupler ends with the code, tells the sender and the other one."""
import math
import unittest

import msgpack
import numpy as np

from harness import Case, Scene
from players import SQUARE, Coupler, Surface, protocol

NAN, INFINITY = math.nan, math.inf


class WrongMessages(Case):
    def refuse(self, row, code, says, make, steps=20, memory=64):
        """make(surface) gives the frames or the message that is sent in step `steps`. Returns by how
        much the coupler's memory grew [kB]: the most it ever had less the most before the message."""
        with Scene("dummies") as scene:
            coupler = scene.start_coupler(measured=True)
            scene.start_dummy("particles", "--height", "1")
            surface = Surface(scene.endpoint)
            try:
                surface.step(steps)
                before = coupler.memory("VmHWM", coupler.only_child())
                frames = make(surface)
                scene.now()
                surface.send(frames)
                error = surface.answer()
                scene.expect("coupler", 3, code, row=row)
                scene.expect("coupler", 3, says)
                scene.expect("sph", 3, code, row=row)
                self.assertIsNotNone(error, "the sender was not told")
                self.assertEqual(error.code, code)
                grown = scene.peak() - before
                self.assertLess(grown, memory * 1024, "kB of extra memory")
                return grown
            finally:
                surface.close()

    def refuse_state(self, row, code, says, **keys):
        with self.subTest(**{key: str(value)[:40] for key, value in keys.items()}):
            self.refuse(row, code, says, lambda surface: surface.state(**keys))

    # ------------------------------------------------------------ row 5

    def header(self, surface, **keys):
        frames = protocol.encode(surface.state())
        header = msgpack.unpackb(frames[0])
        header.update(keys)
        return [msgpack.packb(header)] + frames[1:]

    def test_a_truncated_header(self):
        def cut(surface):
            frames = protocol.encode(surface.state())
            return [frames[0][:-3]] + frames[1:]
        self.refuse(5, "E_MALFORMED", "fem sent a wrong message", cut)

    def test_random_bytes(self):
        noise = np.random.default_rng(5).bytes(300)
        self.refuse(5, "E_MALFORMED", "fem sent a wrong message", lambda _: [noise])

    def test_an_unknown_type(self):
        self.refuse(5, "E_MALFORMED", "99", lambda surface: self.header(surface, m=99))

    def test_a_missing_key(self):
        def without_t(surface):
            frames = protocol.encode(surface.state())
            header = msgpack.unpackb(frames[0])
            del header["t"]
            return [msgpack.packb(header)] + frames[1:]
        self.refuse(5, "E_MALFORMED", "t", without_t)

    def test_bytes_behind_the_map(self):
        def longer(surface):
            frames = protocol.encode(surface.state())
            return [frames[0] + b"\0"] + frames[1:]
        self.refuse(5, "E_MALFORMED", "fem sent a wrong message", longer)

    def test_a_length_that_claims_four_thousand_million_entries(self):
        self.refuse(5, "E_MALFORMED", "fem sent a wrong message", lambda _: [b"\xdd\xff\xff\xff\xff"])

    def test_a_deep_nest(self):
        nest = b"\x81\xa1m" + b"\x91" * 60000 + b"\x05"
        self.refuse(5, "E_MALFORMED", "fem sent a wrong message", lambda _: [nest])

    def test_the_measurement_sees_a_message_of_100_MB(self):
        """A frame below `max` is received before its shape is judged: that much memory, and no more."""
        def large(surface):
            frames = protocol.encode(surface.state())
            return [*frames[:-1], bytes(100 << 20)]
        grown = self.refuse(5, "E_SHAPE", "fem sent a wrong message", large, memory=164)
        self.assertGreater(grown, 90 * 1024)

    # ------------------------------------------------------------ rows 6, 7

    def test_a_missing_frame(self):
        self.refuse(6, "E_SHAPE", "fem", lambda surface: protocol.encode(surface.state())[:-1])

    def test_a_frame_shorter_than_its_shape(self):
        def shorter(surface):
            frames = protocol.encode(surface.state())
            return frames[:-1] + [frames[-1][:-8]]
        self.refuse(6, "E_SHAPE", "fem", shorter)

    def test_another_dtype(self):
        def single(surface):
            frames = protocol.encode(surface.state())
            header = msgpack.unpackb(frames[0])
            header["a"][0][1] = "f4"
            return [msgpack.packb(header), np.zeros(12, "f4").tobytes(), frames[2]]
        self.refuse(6, "E_SHAPE", "f4", single)

    def test_another_number_of_nodes(self):
        rows = np.zeros((5, 3))
        self.refuse_state(6, "E_SHAPE", "5 rows; agreed were 4", x=rows, v=rows)

    def test_a_frame_above_the_limit_closes_the_connection(self):
        with Scene("dummies") as scene:
            coupler = scene.start_coupler(measured=True)
            scene.start_dummy("particles", "--height", "1")
            surface = Surface(scene.endpoint)
            try:
                surface.step(20)
                before = coupler.memory("VmHWM", coupler.only_child())
                frames = protocol.encode(surface.state())
                scene.now()
                surface.send([frames[0], np.zeros((513 << 20) // 8), frames[2]])
                scene.expect("coupler", 3, "fem vanished in step 20", row=7)
                scene.expect("sph", 3, "fem vanished in step 20", row=7)
                self.assertLess(scene.peak() - before, 64 * 1024, "kB of extra memory")
            finally:
                surface.close()

    # ------------------------------------------------------------ row 8

    def test_numbers_that_are_none(self):
        for name in ("x", "v"):
            for value in (NAN, INFINITY):
                rows = np.array(SQUARE["x"], float)
                rows[2, 1] = value
                self.refuse_state(8, "E_NONFINITE", f"{name}[2", **{name: rows})

    def test_steps_that_are_none(self):
        for value in (NAN, INFINITY, 0.0, -1e-4):
            self.refuse_state(8, "E_NONFINITE", "dl", dl=value)

    def refuse_mesh(self, row, code, says, **mesh):
        with self.subTest(says=says), Scene("dummies") as scene:
            scene.start_coupler()
            scene.start_dummy("particles", "--height", "1")
            scene.wait_for_join("sph")
            scene.now()
            with self.assertRaises(protocol.PeerError) as told:
                Surface(scene.endpoint, **mesh).close()
            self.assertEqual(told.exception.code, code)
            scene.expect("coupler", 3, says, row=row)
            scene.expect("sph", 3, says, row=row)

    def test_masses_that_are_none(self):
        for value in (0.0, -1.0, NAN):
            self.refuse_mesh(8, "E_NONFINITE", "mass", mass=[1, 1, value, 1])

    def test_forces_that_are_no_numbers_stop_the_solver(self):
        with Scene() as scene:
            (scene.path / "socket").mkdir(mode=0o700)
            coupler = Coupler(scene.endpoint)
            try:
                scene.start_solver("fem")
                mesh = coupler.welcome_surface()
                f = np.zeros((len(mesh["x"]), 3))
                f[7, 2] = NAN
                scene.now()
                coupler.send(protocol.FORCE, n=0, dt=1e-5, t1=1e-5, fl=0, lim="", f=f)
                scene.expect("fem", 3, "FORCE(0): f[7", row=8)
                self.assertEqual(coupler.receive(protocol.ERROR)["code"], "E_NONFINITE")
            finally:
                coupler.close()

    # ------------------------------------------------------------ rows 9, 10, 13

    def test_another_major_version(self):
        with Scene("dummies") as scene:
            scene.start_coupler()
            scene.start_dummy("particles", "--height", "1")
            scene.now()
            scene.start_dummy("surface", "--version-spoken", "2.0")
            scene.expect("fem", 3, "E_VERSION", within=3, row=9)
            self.assertIn("[2, 0]", scene["fem"].said().replace("2.0", "[2, 0]"))
            scene.start_dummy("surface", name="fem2")       # the seat is still free
            scene.wait_for_step(10)

    def test_a_newer_minor_version_and_unknown_keys_run(self):
        with Scene("dummies") as scene:
            scene.start_coupler("--set", "time.end=0.01")
            scene.start_dummy("particles", "--height", "1")
            newer, protocol.VERSION[1] = protocol.VERSION[1], 7
            try:
                surface = Surface(scene.endpoint)
            finally:
                protocol.VERSION[1] = newer
            self.assertEqual(surface.link.welcome["v"], protocol.VERSION)
            surface.step(10)
            surface.send(self.header(surface, hue="blue", tint=[1, 2]))
            self.assertTrue(surface.link.wait_reply().force)
            surface.n, surface.t = surface.link.n, surface.link.t
            while not surface.link._ended:
                surface.link.send_state(surface.n, surface.t, 1e-4, surface.x, np.zeros((4, 3)))
                reply = surface.link.wait_reply()
                if reply.finish:
                    surface.link.say_goodbye(surface.n)
                else:
                    surface.n, surface.t = surface.n + 1, reply.force["t1"]
            scene.expect("coupler", 0, row=9)

    def test_another_session(self):
        self.refuse(10, "E_SEQUENCE", "belongs to session",
                    lambda surface: surface.state(s=surface.link.session ^ 1))

    def test_a_repeated_and_a_skipped_step(self):
        for shift, says in ((-1, "it is stale"), (1, "steps were skipped")):
            with self.subTest(shift):
                self.refuse(10, "E_SEQUENCE", says,
                            lambda surface, shift=shift: surface.state(n=surface.n + shift))

    def test_another_step_than_granted(self):
        self.refuse(13, "E_TIME", "take t1 of FORCE as it is",
                    lambda surface: surface.state(t=np.nextafter(surface.t, 1)))

    # ------------------------------------------------------------ row 12

    def test_facets_that_cannot_be_used(self):
        self.refuse_mesh(12, "E_MESH", "facet 0 names node 4", quad=[[0, 1, 2, 4]])
        self.refuse_mesh(12, "E_MESH", "facet 0 is degenerate", quad=[[0, 1, 1, 0]])
        self.refuse_mesh(12, "E_MESH", "facet 0 is degenerate", quad=[[0, 2, 1, 3]])

    def test_a_facet_that_shows_its_back(self):
        self.refuse_mesh(12, "E_MESH", "one of them is inverted", x=SQUARE["x"] + [[2, 0, 0], [2, 1, 0]],
                         mass=[1] * 6, quad=[[0, 1, 2, 3], [1, 2, 5, 4]], group=[0, 0])

    # ------------------------------------------------------------ row 22

    def test_a_step_that_collapses_names_the_culprit(self):
        with Scene() as scene:
            scene.now()
            scene.start_trio("--set", "time.min_step=5e-4", "--set", "fem.material=[{name = "
                             "\"rubber\", density = 1500, young_modulus = 1e7, poisson_ratio = 0.4}]")
            says = "(fem: hexahedron"
            scene.expect("coupler", 4, says, within=5, row=22)
            for name in ("sph", "fem"):
                scene.expect(name, 3, says, row=22)
        with Scene() as scene:
            scene.now()
            scene.start_trio("--set", "time.min_step=8.97e-4", "--set", "fem.material=[{name = "
                             "\"rubber\", density = 1500, young_modulus = 1e5, poisson_ratio = 0.4}]")
            scene.expect("sph", 4, "particle", within=5, row=22)
            for name in ("coupler", "fem"):
                scene.expect(name, 3, "particle", row=22)


if __name__ == "__main__":
    unittest.main()
