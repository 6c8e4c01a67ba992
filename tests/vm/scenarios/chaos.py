"""Everything at once, in an order that nobody thought of: WAYMARK_CHAOS_SEED and WAYMARK_CHAOS_MINUTES, else new and 4."""

import itertools
import os
import random
import time

import hearing as heard
from cameras import COUNT
from devices import wait_for_udev
from disks import MOUNT, localize_with_disk
from poses import STALL, assert_expected, small_send_buffers
from service import URL
from service_faults import step_clock

MINUTES = 4
# What the vehicle is promised, in seconds: never silent for longer while locd runs; all cameras' poses so soon after a
# fault is over.
SILENCE_S = 0.5
BACK_S = 5.0
# A service loop's turn, and what the message takes to its clock.
TURN_S = 0.1
# A recording must leave more of its disk of 160 MB free than it will find.
MIN_FREE_BYTES = 20e6
# Writes down by how much it was woken too late: then the emulated machine stood still, or was at something else.
METRONOME = """perl -MTime::HiRes=clock_gettime,CLOCK_MONOTONIC,sleep -e '$| = 1; $last = clock_gettime(CLOCK_MONOTONIC);
while (1) { sleep 0.02; $now = clock_gettime(CLOCK_MONOTONIC); print "$last $now\\n" if $now - $last > 0.06; $last = $now }'"""


class Standstills:
    """When the emulated machine itself came to nothing."""

    def __init__(self, world):
        self.world = world
        self.file = world.share / "standstills"
        world.guest.check("systemctl stop metronome 2>/dev/null; rm -f /share/standstills")
        (world.share / "metronome.sh").write_text(METRONOME + "\n", encoding="utf-8")
        world.guest.check("systemd-run --quiet --collect --unit=metronome --property=StandardOutput=append:/share/standstills "
                          "sh /share/metronome.sh")

    def seconds_within(self, begin_s, end_s):
        total = 0.0
        for line in self.file.read_text(encoding="utf-8").splitlines() if self.file.exists() else []:
            late_from, late_to = (float(word) for word in line.split())
            total += max(0.0, min(late_to, end_s) - max(late_from, begin_s))
        return total

    def end(self):
        self.world.guest.run("systemctl stop metronome")


def now_s(world):
    """The guest's monotonic clock."""
    return float(world.guest.check("perl -MTime::HiRes=clock_gettime,CLOCK_MONOTONIC -e "
                                   "'print clock_gettime(CLOCK_MONOTONIC)'"))


class Faults:
    """What befalls the vehicle. Each returns what ends it again, and that the moment from which on all is well."""

    def __init__(self, world, chance):
        self.world = world
        self.chance = chance
        self.stepped_s = 0.0

    def all(self):
        return (self.unplug, self.stall, self.freeze, self.full_disk, self.clock, self.storm_of_reloads, self.hostile_reload,
                self.killed, self.ended, self.stalled_network)

    def unplug(self):
        camera = self.chance.choice(self.world.cameras)
        port = camera.port()
        camera.unplug()

        def replug():
            camera.plug(port)
            return wait_for_udev(self.world, camera.serial)
        return f"unplug {camera.serial}", replug

    def _order(self, order):
        camera = self.chance.choice(self.world.cameras)
        camera.order(order)

        def go():
            camera.order("go")
            return now_s(self.world)
        return f"{order} {camera.serial}", go

    def stall(self):
        return self._order("stall")

    def freeze(self):
        return self._order("freeze")

    def full_disk(self):
        self.world.locd.request("start")
        free = "$(df --output=avail -B1 {} | tail -1)".format(MOUNT)
        self.world.guest.check(f"fallocate -l $(({free} - {MIN_FREE_BYTES / 2:.0f})) {MOUNT}/others")

        def room():
            self.world.guest.check(f"rm {MOUNT}/others")
            self.world.locd.request("stop")
            return now_s(self.world)
        return "full disk while recording", room

    def clock(self):
        step_s = self.chance.choice((3600, -3600, 0.05, -0.05, 86400))
        step_clock(self.world, step_s)
        self.stepped_s += step_s
        return f"clock by {step_s} s", lambda: now_s(self.world)

    def storm_of_reloads(self):
        self.world.guest.check("for i in $(seq 50); do systemctl kill -s HUP locd; done")
        return "50 reloads", lambda: now_s(self.world)

    def hostile_reload(self):
        file, make = self.chance.choice((
            ("locd.toml", "{ cat /share/etc/locd.toml; echo; head -c 140000 /dev/zero | tr '\\0' k; echo ' = 1'; }"),
            ("locd.toml", "{ printf a; for i in $(seq 60000); do printf .a; done; echo ' = 1'; }"),
            ("rig.yaml", "{ cat /share/etc/rig.yaml; head -c 140000 /dev/zero | tr '\\0' k; echo ': 1'; }"),
            ("rig.yaml", "printf '\"T_x\\\\nWATCHDOG=trigger\": 1\\n'"),
            ("room.map", "head -c 3000 /share/etc/room.map"),
            ("room.map", "head -c 100000 /dev/urandom"),
            ("markers.toml", "head -c 100000 /dev/urandom")))
        self.world.guest.check(f"{make} >/etc/locd/{file}; systemctl kill -s HUP locd")

        def restore():
            self.world.guest.check(f"cp /share/etc/{file} /etc/locd/{file}; systemctl kill -s HUP locd")
            return now_s(self.world)
        return f"reload of another {file}", restore

    def _restarted(self):
        self.world.wait_until("it runs again", lambda: self.world.locd.show("ActiveState") == "active", timeout_s=90)
        return now_s(self.world)

    def killed(self):
        self.world.guest.check("systemctl kill -s KILL locd")
        return "kill -9", self._restarted

    def ended(self):
        self.world.guest.check("systemctl kill -s TERM locd")
        return "kill", self._restarted

    def stalled_network(self):
        self.world.guest.check(STALL)

        def release():
            self.world.guest.check("tc qdisc del dev dummy0 root")
            return now_s(self.world)
        return "stalled network", release


def chaos(world):
    """Whatever befalls it, in whatever order: no pose is wrong and OK, it is not silent while it runs, and it is back
    soon."""
    seed = int(os.environ.get("WAYMARK_CHAOS_SEED", random.SystemRandom().randrange(1 << 32)))
    minutes = float(os.environ.get("WAYMARK_CHAOS_MINUTES", MINUTES))
    print(f"WAYMARK_CHAOS_SEED={seed} WAYMARK_CHAOS_MINUTES={minutes}", flush=True)
    chance = random.Random(seed)
    world.locd.quiet()
    world.prepare()
    world.locd.configure(url=URL.replace("ttl=0", "ttl=1"), min_free_bytes=MIN_FREE_BYTES)
    world.guest.check("modprobe sch_tbf")
    standstills = Standstills(world)
    faults = Faults(world, chance)
    with small_send_buffers(world):
        localize_with_disk(world)
        everything = heard.Hearing(world.share)
        try:
            end = time.monotonic() + 60 * minutes
            while time.monotonic() < end:
                befall(world, faults, standstills)
        finally:
            step_clock(world, -faults.stepped_s)
            standstills.end()
            world.guest.run("tc qdisc del dev dummy0 root")
    poses = everything.since_mark("POSE")
    for pose in poses:
        if pose["status"] == heard.OK:
            assert_expected(world, pose)
    for before, after in itertools.pairwise(poses):
        assert_not_silent(before, after, standstills)
    print(f"{len(poses)} poses, {sum(pose['status'] == heard.OK for pose in poses)} of them OK", flush=True)
    world.locd.stop()


def befall(world, faults, standstills):
    """One fault, for some seconds, and what comes after."""
    what, end = faults.chance.choice(faults.all())()
    print(what, flush=True)
    time.sleep(faults.chance.uniform(0, 5))  # the fault lasts: nothing is waited for
    well_s = end()
    world.hearing.mark()
    pose = world.hearing.wait_for(
        f"pose of all cameras after: {what}", "POSE",
        lambda m: m["cameras_used"] == COUNT and m["status"] in (heard.OK, heard.DEGRADED) and
        exposed_s(m) > well_s, timeout_s=90)
    took_s = exposed_s(pose) - well_s
    late_s = standstills.seconds_within(well_s, pose["heard_s"])
    print(f"    back after {took_s:.1f} s, of which the machine stood still for {late_s:.1f} s", flush=True)
    assert took_s - late_s <= BACK_S, f"{took_s} s after: {what}"


def exposed_s(message):
    """On the guest's clock: what solving takes says nothing in an emulated machine."""
    return message["heard_s"] - message["latency_ms"] / 1e3


def assert_not_silent(before, after, standstills):
    """Two poses of a session, one after the other: neither was lost on the way."""
    if after["session"] != before["session"] or after["seq"] != before["seq"] + 1:
        return
    gap_s = (after["utime_published"] - before["utime_published"]) / 1e6
    late_s = standstills.seconds_within(before["heard_s"] - 1, after["heard_s"])
    assert gap_s - late_s <= SILENCE_S + TURN_S, f"silent for {gap_s} s (it stood still for {late_s} s): {before} {after}"
