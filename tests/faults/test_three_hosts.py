"""A run across three hosts: network namespaces with addresses of their own, tcp, CURVE keys. Needs root."""
import os
import subprocess
import unittest

from harness import BIN, TOP, Case, Scene, record

PORT = 5571


def ip(*words):
    return subprocess.run(["ip", *words], capture_output=True, text=True, check=True)


class Hosts:
    """Three namespaces: the coupler's, with a cable to each of the solvers'."""

    def __init__(self):
        self.names = {who: f"undertow{os.getpid()}{who}" for who in ("coupler", "sph", "fem")}
        self.made = []
        self.cables = []

    def __enter__(self):
        try:
            for name in self.names.values():
                ip("netns", "add", name)
                self.made.append(name)
            for number, who in enumerate(("sph", "fem")):
                self.lay_cable(number, who)
        except (OSError, subprocess.CalledProcessError) as error:
            self.__exit__()
            raise unittest.SkipTest("network namespaces cannot be made here (they need root): "
                                    + str(getattr(error, "stderr", None) or error).strip()) from None
        return self

    def lay_cable(self, number, who):
        ends = [f"ut{os.getpid() % 100000}{who}{end}" for end in "ab"]
        ip("link", "add", ends[0], "type", "veth", "peer", "name", ends[1])
        for end, host, last in ((ends[0], "coupler", 1), (ends[1], who, 2)):
            name = self.names[host]
            ip("link", "set", end, "netns", name)
            ip("-n", name, "addr", "add", f"10.77.{number}.{last}/24", "dev", end)
            ip("-n", name, "link", "set", end, "up")

    def __exit__(self, *_):
        for name in self.made:
            ip("netns", "del", name)

    def on(self, who, command):
        return ["ip", "netns", "exec", self.names[who], *command]

    @staticmethod
    def address(who):
        return f"tcp://10.77.{('sph', 'fem').index(who)}.1:{PORT}"


def make_keys(folder):
    subprocess.run([TOP / "scripts" / "undertow", "keys", folder], check=True, capture_output=True)
    return folder


class ThreeHosts(Case):
    def start(self, scene, hosts, who, keys, *options):
        program = "coupler" if who == "coupler" else f"{who}_solver"
        place = ["--endpoint", f"tcp://0.0.0.0:{PORT}"] if who == "coupler" else [
            "--coupler", hosts.address(who), "--threads", "1"]
        return scene.start(who, hosts.on(who, [
            BIN / program, scene.case, "--out", scene.out, *place, "--quiet", "--set",
            'coupling.transport="tcp"', *(["--keys", keys] if keys else []), *options]))

    def test_three_hosts_with_keys(self):
        with Hosts() as hosts, Scene() as scene:
            keys = make_keys(scene.path / "keys")
            for who in ("coupler", "sph", "fem"):
                self.start(scene, hosts, who, keys, "--set", "time.end=0.02")
            for who in ("coupler", "sph", "fem"):
                scene.expect(who, 0, within=60)
            self.assertIn("travel by tcp", scene["coupler"].said())
            scene.expect_output_whole()
            record(25, "three network namespaces, tcp, CURVE: done")

    def test_a_wrong_key_is_refused_soon_and_in_words(self):
        with Hosts() as hosts, Scene() as scene:
            keys, others = make_keys(scene.path / "keys"), make_keys(scene.path / "others")
            self.start(scene, hosts, "coupler", keys, "--set", "coupling.join_timeout=6")
            scene.wait_for_coupler()
            scene.now()
            self.start(scene, hosts, "sph", others)
            scene.expect("sph", 3, "E_KEY", within=3, row=25)
            scene.expect("coupler", 3, "refused for their keys", within=8, row=25)

    def test_without_keys_no_address_but_loopback_is_taken(self):
        with Hosts() as hosts, Scene() as scene:
            self.start(scene, hosts, "coupler", None)
            scene.expect("coupler", 2, "undertow keys FOLDER", within=2, row=25)
            self.start(scene, hosts, "sph", None)
            scene.expect("sph", 2, "undertow keys FOLDER", within=2, row=25)


if __name__ == "__main__":
    unittest.main()
