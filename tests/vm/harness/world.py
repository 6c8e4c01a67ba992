"""All that a scenario works with, and the state that every one begins with."""

import json
import math
import pathlib
import subprocess
import time

import hearing as heard
from cameras import COUNT, Camera
from guest import Guest
from hearing import PATIENCE, Hearing
from machine import Machine
from service import URL, Locd


def read_tum(path):
    """Lines of a TUM file: (stamp as text, position, quaternion x y z w)."""
    rows = [line.split() for line in pathlib.Path(path).read_text(encoding="utf-8").splitlines()
            if line and not line.startswith("#")]
    return [(row[0], [float(v) for v in row[1:4]], [float(v) for v in row[4:8]]) for row in rows]


def pose_distance(a, b):
    """(m, deg) between two poses (position, quaternion x y z w)."""
    (ax, ay, az, aw), (bx, by, bz, bw) = a[1], b[1]
    # The vector part of a^-1 b: exact for small angles, whose cosine says nothing after nine decimals.
    x = aw * bx - ax * bw - ay * bz + az * by
    y = aw * by - ay * bw - az * bx + ax * bz
    z = aw * bz - az * bw - ax * by + ay * bx
    cosine = abs(ax * bx + ay * by + az * bz + aw * bw)
    return math.dist(a[0], b[0]), math.degrees(2 * math.atan2(math.hypot(x, y, z), cosine))


BOOT_S = 120


class World:
    def __init__(self, paths):
        self.paths = paths
        self.run = pathlib.Path(paths["run"])
        self.machine = Machine(self.run)
        self.share = self.machine.share
        self.guest = Guest(self.run)
        self.cameras = [Camera(self.run, paths, i) for i in range(COUNT)]
        self.hearing = Hearing(self.share)
        self.locd = Locd(self.guest, self.share, paths["inputs"])
        self.capture = pathlib.Path(paths["inputs"]) / "capture"

    def boot(self):
        """Gives the machine power and returns when it is up: its state and uptime (s)."""
        self.machine.start()
        deadline = time.monotonic() + BOOT_S * PATIENCE
        while True:
            try:
                return self.guest.check("systemctl is-system-running --wait; cut -d' ' -f1 /proc/uptime", BOOT_S)
            except OSError:  # QEMU has not opened its sockets yet
                if time.monotonic() > deadline or not self.machine.is_running():
                    raise
                time.sleep(0.2)

    def cut_power(self):
        """Of the machine and of its cameras."""
        for camera in self.cameras:
            camera.unplug()
        self.machine.kill()
        self.guest.hang_up()

    # What scenarios begin with.

    def plug_all(self):
        """Every camera in the port of its own number, and all is well with it."""
        for port, camera in enumerate(self.cameras):
            if camera.port() != port:
                camera.unplug()
        for port, camera in enumerate(self.cameras):
            if camera.port() is None:
                camera.plug(port)
            else:
                camera.order("go")

    def install(self):
        """The package, unless it is installed."""
        self.guest.check("test -x /usr/bin/locd || dpkg -i /share/waymark-locd.deb", 180)

    def linked(self):
        """Serial numbers of the cameras that udev has given the package's links."""
        return set(self.guest.run("cd /dev/waymark && echo *")[1].split())

    def prepare(self):
        """The package installed, a listener, three cameras that the guest has seen come; locd may run or not."""
        self.install()
        self.listen()
        elsewhere = [camera for port, camera in enumerate(self.cameras) if camera.port() != port]
        for camera in elsewhere:
            camera.unplug()
        gone = {camera.serial for camera in elsewhere}
        self.wait_until(f"{gone} are gone", lambda: not gone or not gone & self.linked())
        self.plug_all()
        self.wait_until("all cameras are there", lambda: self.linked() >= {c.serial for c in self.cameras})

    def localize(self):
        """All prepared, locd running with the usual configuration unless it runs already, poses of all three."""
        self.prepare()
        if self.locd.show("ActiveState") != "active":
            self.locd.configure()
            self.locd.start()
        return self.wait_for_full_pose()

    def listen(self):
        """A listener in the guest, unless one runs, and a way for multicast as a vehicle without a network has."""
        self.guest.check("test -e /sys/class/net/dummy0 || { modprobe dummy numdummies=0; ip link add dummy0 type dummy; "
                         "ip address add 192.168.77.1/24 dev dummy0; ip link set dummy0 up; "
                         "ip route add default via 192.168.77.2 dev dummy0; }; systemctl is-active --quiet listener || "
                         f"systemd-run --quiet --unit=listener /share/bin/vm_listener '{URL}' /share/heard.jsonl")

    def stop_listening(self):
        """No listener, and no way for multicast."""
        self.guest.check("systemctl stop listener; ip link delete dummy0; ! ip route get 239.255.76.67")

    def suspend(self):
        """The machine sleeps for 5 s: everything is as it would be (tasks frozen, devices without power, clocks
        as after a sleep) but for the firmware's part, which the kernel's own test of suspends leaves out.
        virtio-9p does not come back from one; so there is no share meanwhile, and nobody listens."""
        self.guest.check("systemctl stop listener; umount /share && modprobe -r 9pnet_virtio 9p || exit; "
                         "echo core >/sys/power/pm_test; echo mem >/sys/power/state; slept=$?; "
                         "modprobe -a 9pnet_virtio 9p && mount /share && exit $slept")
        self.listen()

    # What they wait for and look at.

    def wait_for_full_pose(self, timeout_s=90, count=1):
        """A pose that all cameras carry, heard from now on."""
        self.hearing.mark()
        return self.hearing.wait_for(
            "pose of all cameras", "POSE",
            lambda m: m["status"] in (heard.OK, heard.DEGRADED) and m["cameras_used"] == COUNT, timeout_s, count)

    def distance_to_expected(self, message):
        """(m, deg) from a message's pose to the nearest of those that the capture's images give."""
        w, x, y, z = message["quaternion"]
        pose = (message["position"], [x, y, z, w])
        expected = read_tum(pathlib.Path(self.paths["inputs"]) / "expected.tum")
        return min(pose_distance(pose, row[1:]) for row in expected)

    def native(self, program, *arguments):
        """Runs one of our programs on this machine; (exit code, output)."""
        done = subprocess.run([self.paths[program], *[str(a) for a in arguments]], check=False, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        return done.returncode, done.stdout

    @staticmethod
    def wait_until(what, look, timeout_s=60):
        """What `look` gives as soon as that is something; AssertionError when time is up."""
        deadline = time.monotonic() + timeout_s * PATIENCE
        while not (seen := look()):
            assert time.monotonic() < deadline, f"not within {timeout_s} s: {what}"
            time.sleep(0.3)
        return seen

    @staticmethod
    def one_of_three(what, bar_s, measure):
        """A time that must hold once in three: what a stall of the emulation adds is not locd's."""
        for _ in range(3):
            took_s = measure()
            print(f"{what}: {took_s:.2f} s", flush=True)
            if took_s <= bar_s:
                return
        raise AssertionError(f"{what}: never within {bar_s} s")


def load(paths_file):
    return World(json.loads(pathlib.Path(paths_file).read_text(encoding="utf-8")))
