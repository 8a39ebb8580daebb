"""Rows 1 to 4, 14 and 21 of docs/fault_matrix.md: programs that are killed, stopped, or hang."""
import signal
import subprocess
import time
import unittest

from harness import BIN, Case, Scene, record


class LostPeers(Case):
    def test_killed_before_hello(self):
        with Scene() as scene:
            scene.now()
            scene.start_coupler("--set", "coupling.join_timeout=4")
            scene.start_solver("fem")
            sph = scene.start("sph", ["/bin/sleep", "60"])      # a solver that reads its mesh, say
            sph.kill()
            scene.expect("coupler", 3, "nobody joined as particles (joined: fem)", within=5, row=1)
            scene.expect("fem", 3, "nobody joined as particles", row=1)

    def kill_in_mid_step(self, who, other):
        with Scene() as scene:
            scene.start_trio()
            scene.wait_for_step(300)
            scene.now()
            scene[who].kill()
            says = f"{who} vanished in step"
            scene.expect("coupler", 3, says, row=2)
            scene.expect(other, 3, says, row=2)
            fields = scene.expect_output_whole(50)
            self.assertLess(abs(fields[0] - fields[1]), 3)

    def test_sph_is_killed(self):
        self.kill_in_mid_step("sph", "fem")

    def test_fem_is_killed(self):
        self.kill_in_mid_step("fem", "sph")

    def test_the_coupler_is_killed(self):
        with Scene() as scene:
            scene.start_trio()
            scene.wait_for_step(300)
            scene.now()
            scene["coupler"].kill()
            for name in ("sph", "fem"):
                scene.expect(name, 3, "vanished in step", row=14)
            scene.expect_output_whole(50)

    def test_stopped_past_the_deadline(self):
        with Scene() as scene:
            scene.start_trio("--set", "coupling.deadline=3")
            scene.wait_for_step(100)
            scene["sph"].signal(signal.SIGSTOP)
            scene.now()
            scene.expect("coupler", 3, "sph has been silent for 3 s in step", within=4, row=3)
            scene.expect("fem", 3, "sph has been silent for 3 s in step", within=4, row=3)
            scene["sph"].signal(signal.SIGCONT)
            scene.now()
            scene.expect("sph", 3, "E_", row=3)
            scene.expect_output_whole(20)

    def test_a_hang_in_the_programs_own_code(self):
        """The connection lives, its thread answers: only the deadline finds it."""
        with Scene("dummies") as scene:
            scene.start_coupler("--set", "coupling.deadline=3")
            scene.start_dummy("particles", "--height", "1", "--hang-at-step", "500")
            scene.start_dummy("surface")
            scene.wait_until(lambda: "hangs" in scene["sph"].said(), "the hang")
            scene.now()
            scene.expect("coupler", 3, "sph has been silent for 3 s in step 500", within=4, row=4)
            scene.expect("fem", 3, "sph has been silent for 3 s in step 500", within=4, row=4)

    # ------------------------------------------------------------ pauses and clocks

    def run_to_the_end(self, disturb=None, **how):
        """The bytes of the fields and of the forces of a run of 3 s, 5500 steps."""
        import h5py
        with Scene() as scene:
            scene.start_trio("--set", "time.end=3", "--set", "output.fields_every=0.03", **how)
            if disturb:
                scene.wait_for_outputs(1)
                disturb(scene)
            scene.now()
            for name in ("coupler", "sph", "fem"):
                scene.expect(name, 0, within=60)
            result = {path.name: path.read_bytes() for path in scene.out.glob("*.csv")}
            for name in ("sph", "fem"):
                with h5py.File(scene.out / f"{name}.vtkhdf", "r") as file:
                    result[name] = file["VTKHDF/Points"][()].tobytes()
            return result

    def test_pauses_change_no_bit(self):
        def pause(scene):
            for seconds in (0.1, 0.1, 1.2):     # a busy scheduler, twice; Ctrl-Z
                for name in ("sph", "coupler", "fem"):
                    scene[name].signal(signal.SIGSTOP)
                    self.assertIsNone(scene[name].process.poll(), f"{name} had ended before its pause")
                    time.sleep(seconds)
                    scene[name].signal(signal.SIGCONT)
                    time.sleep(0.005)       # some steps between two pauses
        plain, paused = self.run_to_the_end(), self.run_to_the_end(pause)
        for name, content in plain.items():
            self.assertEqual(content, paused[name], f"{name} differs after pauses")
        record(3, "stopped and continued within the deadline: every field and history "
                          "has the same bits")

    def test_a_clock_that_jumps_changes_nothing(self):
        library = BIN.parent / "lib" / "libclock_jump.so"
        if not library.exists():
            library = next(BIN.parent.rglob("libclock_jump.so"))
        shown = subprocess.run(["date", "+%s"], env={"LD_PRELOAD": str(library)}, text=True,
                               capture_output=True, check=True).stdout
        self.assertGreater(abs(int(shown) - time.time()), 1000, "the clock was to jump")
        plain = self.run_to_the_end()
        jumping = self.run_to_the_end(environment={"LD_PRELOAD": str(library)})
        for name, content in plain.items():
            self.assertEqual(content, jumping[name], f"{name} differs when the clock jumps")
        record(21, "wall clock jumping by two hours every 5 ms: exit 0, "
                           "every field and history has the same bits")


if __name__ == "__main__":
    unittest.main()
