"""All that happens to vehicles, at random and several at once: what must hold holds through it, whatever the order."""

import os
import random
import statistics

import hearing as heard
from devices import wait_for_udev
from disks import MOUNT, localize_with_disk
from poses import STALL
from service_faults import step_clock

# In CI a few minutes of one seed; an hour, of another: bench/results.md has the command.
CHAOS_S = float(os.environ.get("WAYMARK_VM_CHAOS_S", "150"))
SEED = int(os.environ.get("WAYMARK_VM_CHAOS_SEED", "1"))

# How long something stays wrong, s, and how much of it there is at a time.
LASTS_S = (0.2, 8)
AT_ONCE = (1, 3)
# What locd promises on a machine that does not stand still: FAULTS. Here it is measured and said; the emulation,
# which stands still when the computer has other work, decides nothing.
BACK_S = 5
SILENT_S = 0.5

DAMAGED_FILES = (
    "head -c 3000 /share/etc/room.map >/etc/locd/room.map",
    ": >/etc/locd/room.map",
    "head -c 20000 /dev/urandom >/etc/locd/room.map",
    "rm /etc/locd/room.map; mkfifo /etc/locd/room.map",
    "truncate -s 5G /etc/locd/room.map",
    "printf '[[[[[[' >>/etc/locd/locd.toml",
    "sed -i 's/^deadline_ms.*/deadline_ms = nan/' /etc/locd/locd.toml",
    "head -c 5000 /dev/urandom >/etc/locd/rig.yaml",
    "sed -i 's/^path.*/path = \"other.map\"/; s/^url.*/url = \"udpm:\\/\\/1.2.3.4:5\"/' /etc/locd/locd.toml",
)


class Attacks:
    """Each does something and returns what undoes it. Those of one kind that would undo each other bear one name
    before the first underscore, and are never there together."""

    def __init__(self, world, chance):
        self.world = world
        self.chance = chance

    def _ordered(self, camera, order):
        camera.order(order)
        return lambda: camera.order("go")

    def camera_unplugged(self):
        camera = self.chance.choice(self.world.cameras)
        port = camera.port()
        camera.unplug()

        def replug():
            camera.plug(port)
            wait_for_udev(self.world, camera.serial)
        return replug

    def camera_stalled(self):
        return self._ordered(self.chance.choice(self.world.cameras), "stall")

    def camera_frozen(self):
        return self._ordered(self.chance.choice(self.world.cameras), "freeze")

    def camera_useless(self):
        return self._ordered(self.chance.choice(self.world.cameras), f"paint {self.chance.choice((0, 128, 255))}")

    def camera_damaged(self):
        return self._ordered(self.chance.choice(self.world.cameras), "short 1000")

    def disk_full(self):
        free = f"$(($(df --output=avail -B1 {MOUNT} | tail -1) - {self.chance.choice((0, 100_000, 30_000_000))}))"
        self.world.guest.run(f"fallocate -l {free} {MOUNT}/others")
        return lambda: self.world.guest.check(f"rm -f {MOUNT}/others")

    def recording_started(self):
        self.world.guest.run("echo start | nc -U -N -w 5 /run/locd/control")
        return lambda: self.world.guest.run("echo stop | nc -U -N -w 20 /run/locd/control")

    def clock_set(self):
        step_s = self.chance.choice((-86400.0, -3600.0, -1.0, -0.05, 0.05, 1.0, 3600.0, 86400.0))
        step_clock(self.world, step_s)
        return lambda: step_clock(self.world, -step_s)

    def reload_asked(self):
        self.world.guest.run(f"for i in $(seq {self.chance.randint(1, 20)}); do systemctl kill -s HUP locd; done")
        return lambda: None

    def reload_hostile(self):
        damage = self.chance.choice(DAMAGED_FILES)
        self.world.guest.check(damage)
        self.world.guest.run("systemctl reload locd")

        def restore():
            self.world.guest.check("rm -f /etc/locd/room.map; cp /share/etc/* /etc/locd/ && chmod 644 /etc/locd/*")
            self.world.guest.run("systemctl reload locd")
        return restore

    def service_killed(self):
        signal = self.chance.choice(("KILL", "TERM", "ABRT", "SEGV"))
        self.world.guest.run(f"kill -{signal} {self.world.locd.pid()}")
        return lambda: None

    def network_stalled(self):
        self.world.guest.check(f"modprobe sch_tbf && {STALL}")
        return lambda: self.world.guest.check("tc qdisc del dev dummy0 root")

    def network_gone(self):
        self.world.guest.check("ip link set dummy0 down")
        return lambda: self.world.guest.check("ip link set dummy0 up && ip route add default via 192.168.77.2 dev dummy0")

    def all(self):
        return {name: getattr(self, name) for name in dir(self)
                if "_" in name.strip("_") and not name.startswith("_")}


class Watch:
    """What must hold of everything heard: no pose that is OK lies elsewhere; the time between two messages."""

    def __init__(self, world):
        self.world = world
        self.hearing = heard.Hearing(world.share)
        self.last = None
        self.deaf = []  # (from, to), s of the guest: when nobody could hear
        self.good = 0
        self.wrong = []
        self.gaps_s = []

    def look(self):
        for message in self.hearing.take("POSE"):
            if message["status"] == heard.OK:
                self.good += 1
                metres, degrees = self.world.distance_to_expected(message)
                # Twice what assert_expected allows all three cameras: one alone tells less.
                if metres > 0.02 or degrees > 0.6:
                    self.wrong.append(f"OK, and {metres} m, {degrees} deg off: {message}")
                    print(self.wrong[-1], flush=True)
            if self.last and message["session"] == self.last["session"]:
                begin, end = self.last["heard_s"], message["heard_s"]
                if not any(begin < to + 1 and since < end for since, to in self.deaf):
                    self.gaps_s.append(end - begin)
            self.last = message


def guest_s(world):
    return float(world.guest.check("cut -d' ' -f1 /proc/uptime"))


def one_round(world, watch, attacks, chance):
    """Some attacks at once, all undone, all well again; the names, and how long it took from the last one's end."""
    names = chance.sample(sorted(attacks), chance.randint(*AT_ONCE))
    kinds = [name.partition("_")[0] for name in names]
    names = [name for i, name in enumerate(names) if kinds[i] not in kinds[:i]]
    began = guest_s(world)
    undo = [attacks[name]() for name in names]
    until = guest_s(world) + chance.uniform(*LASTS_S)
    world.wait_until("the attack's time is over", lambda: guest_s(world) >= until)
    chance.shuffle(undo)
    for end in undo:
        end()
    ended = guest_s(world)
    if any(name.startswith("network") for name in names):
        watch.deaf.append((began, ended))
    world.hearing.mark()
    pose = world.hearing.wait_for(
        f"pose of all cameras after {names}", "POSE",
        lambda m: m["status"] in (heard.OK, heard.DEGRADED) and m["cameras_used"] == 3 and m["heard_s"] >= ended,
        timeout_s=60)
    watch.look()
    return names, pose["heard_s"] - ended


def chaos(world):
    """Unplugged, hung, blind and damaged cameras, full disks, wrong clocks, reloads good and hostile, kills, networks
    stalled and gone, at random: no wrong pose is OK, all is well afterwards, each time."""
    localize_with_disk(world)
    chance = random.Random(SEED)
    attacks = Attacks(world, chance).all()
    watch = Watch(world)
    print(f"seed {SEED}, {CHAOS_S:.0f} s, {len(attacks)} kinds", flush=True)
    rounds, back_s = 0, []
    until = guest_s(world) + CHAOS_S
    try:
        while guest_s(world) < until:
            names, took_s = one_round(world, watch, attacks, chance)
            # A start that could not go well is tried again 30 s later.
            tried_again = {"service_killed", "reload_hostile"} <= set(names)
            if not tried_again:
                back_s.append(took_s)
            late = "  <- late" if took_s > BACK_S and not tried_again else ""
            rounds += 1
            print(f"{rounds:4d} {', '.join(names)}: back after {took_s:.2f} s{late}", flush=True)
    finally:
        gaps_s = sorted(watch.gaps_s) or [0]
        print(f"{rounds} rounds; {watch.good} OK poses, {len(watch.wrong)} wrong; back after {statistics.median(back_s or [0]):.2f} s "
              f"in the median, {max(back_s or [0]):.2f} s at most, {sum(t > BACK_S for t in back_s)} beyond {BACK_S} s; "
              f"silent for {gaps_s[-1]:.2f} s at most, {sum(g > SILENT_S for g in gaps_s)} of {len(gaps_s)} "
              f"beyond {SILENT_S} s", flush=True)
        world.guest.run(f"systemctl stop locd; umount {MOUNT}")
        world.locd.configure()
    assert not watch.wrong, watch.wrong
