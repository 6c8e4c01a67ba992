"""Disks that are full, and power that is cut."""

import shutil
import subprocess

from poses import assert_expected, images_recorded, start_recording

MOUNT = "/var/lib/locd/recordings"


def localize_with_disk(world):
    """Poses of all cameras; recordings go to the disk of their own. The session."""
    world.prepare()
    if world.guest.run(f"mountpoint -q {MOUNT}")[0] != 0:
        world.locd.stop()  # it does not see what is mounted later
        # Of itself the kernel brings to the disk what is new every 5 s; here it leaves that to locd.
        world.guest.check(f"mount -o commit=300 /dev/vdb {MOUNT} && chown locd:locd {MOUNT}")
    return world.localize()["session"]


# What a recording may take, and what it must leave on its disk of 160 MB (harness/machine.py), in bytes: some
# eight sets of three images with 128 kB each.
MAX_BYTES = 3e6
MIN_FREE_BYTES = 20e6


def disk_full(world):
    """Recordings are a ring within their budget and leave room on the disk; taken by others, recording ends, is said."""
    session = localize_with_disk(world)
    world.guest.check(f"rm -rf {MOUNT}/*")
    world.locd.configure(min_free_bytes=MIN_FREE_BYTES, max_bytes=MAX_BYTES)
    world.guest.check("systemctl reload locd")
    folder = start_recording(world)
    oldest = f"ls {folder}/cam0 | sort | head -1"
    world.hearing.wait_for("recording", "STATUS", lambda m: m["recorded_sets"] >= 3)
    first = world.guest.check(oldest)
    world.wait_until("the oldest go", lambda: world.guest.check(oldest) != first)
    used = int(world.guest.check(f"du -sb --apparent-size {folder} | cut -f1"))
    assert MAX_BYTES / 2 < used < 1.1 * MAX_BYTES, f"{used} bytes recorded"
    # Somebody else takes all but what recordings leave, and more.
    free = "$(df --output=avail -B1 {} | tail -1)".format(MOUNT)
    world.guest.check(f"fallocate -l $(({free} - {MIN_FREE_BYTES:.0f} - 1000000)) {MOUNT}/others")
    world.hearing.mark()
    world.hearing.wait_for("recording goes on", "STATUS", lambda m: m["recording"], count=3)
    left = int(world.guest.check(f"echo {free}"))
    assert left >= MIN_FREE_BYTES - 4096 * 8, f"{left} bytes are free"
    world.guest.check(f"fallocate -l {MIN_FREE_BYTES / 2:.0f} {MOUNT}/more")
    world.hearing.wait_for("alert that recording ended", "ALERT",
                           lambda m: m["raised"] and m["kind"] == "RECORDING", timeout_s=90)
    # Two thirds are left: the others took a megabyte of it.
    ended = world.hearing.wait_for("its end, and what it holds", "STATUS",
                                   lambda m: not m["recording"] and m["recorded_bytes"] > MAX_BYTES / 3)
    images = images_recorded(ended)
    assert world.wait_for_full_pose()["session"] == session
    shutil.rmtree(world.share / "full", ignore_errors=True)
    world.guest.check(f"cp -r {folder} /share/full; rm -rf {MOUNT}/*")
    assert not list((world.share / "full").rglob(".*.part")), "a half-written image is left"
    code, text = world.native("compare_recording", world.share / "full", world.capture, "--images", images)
    assert code == 0, f"{images} images were recorded: {text}"
    world.locd.configure()
    world.guest.check("systemctl reload locd")


def failing_disk(world):
    """The disk fails while recording, or is gone: the recording ends and it is said; poses go on."""
    localize_with_disk(world)
    port = world.guest.check("readlink -f /sys/block/vdb/device/..")
    for damage in (f"echo 1 >{port}/remove",
                   # What the kernel does when a disk gives an error: from now on it is read-only.
                   f"mount -o remount,errors=remount-ro {MOUNT} && echo 1 >/sys/fs/ext4/vdb/trigger_fs_error"):
        session = localize_with_disk(world)
        start_recording(world)
        world.hearing.wait_for("recording", "STATUS", lambda m: m["recorded_sets"] >= 2)
        world.hearing.mark()
        world.guest.check(damage)
        world.hearing.wait_for("alert that recording ended", "ALERT",
                               lambda m: m["raised"] and m["kind"] == "RECORDING", timeout_s=90)
        assert world.wait_for_full_pose()["session"] == session
        world.locd.stop()
        world.guest.check(f"umount {MOUNT}; echo 1 >/sys/bus/pci/rescan && udevadm settle && test -b /dev/vdb")


def power_back(world):
    """The computer loses its power and gets it again: locd starts with it, with no network yet, and localizes."""
    session = world.localize()["session"]
    world.guest.check("systemctl enable --quiet locd && sync")
    world.cut_power()
    world.plug_all()
    print(world.boot())
    world.wait_until("locd is ready", lambda: world.locd.show("ActiveState") == "active", timeout_s=120)
    assert world.guest.run("ip route get 239.255.76.67")[0] != 0, "there is a network"
    world.listen()
    pose = world.wait_for_full_pose()
    assert pose["session"] != session
    assert_expected(world, pose)
    assert world.locd.show("NRestarts") == "0", world.locd.journal()


def steadily_recorded(world):
    """The last statuses heard of a recording under way for a while, each of one set more than the one before; nothing
    while sets come otherwise: then the disk, or all, stands still."""
    statuses = world.hearing.since_mark("STATUS")[-3:]
    sets = [m["recorded_sets"] for m in statuses]
    return statuses if sets[0] >= 6 and sets == [sets[0], sets[0] + 1, sets[0] + 2] else None


def power_cut(world):
    """The power goes while recording: what lies on the disk is a capture that lacks a second at most."""
    localize_with_disk(world)
    folder = start_recording(world)
    world.hearing.wait_for("recording", "STATUS", lambda m: m["recorded_sets"] >= 6, timeout_s=90, count=3)
    statuses = world.wait_until("it records a set a second", lambda: steadily_recorded(world), timeout_s=90)
    world.machine.kill()
    disk = world.machine.recordings
    repaired = subprocess.run(["e2fsck", "-fy", disk], check=False, capture_output=True, text=True)
    assert repaired.returncode in (0, 1), repaired.stdout
    shutil.rmtree(world.run / "cut", ignore_errors=True)
    (world.run / "cut").mkdir()
    subprocess.run(["debugfs", "-R", f"rdump {folder.removeprefix(MOUNT)} {world.run / 'cut'}", disk], check=True,
                   capture_output=True)
    capture = next((world.run / "cut").iterdir())
    # The status may be a second old, the disk another.
    images = images_recorded(statuses[0])
    code, text = world.native("compare_recording", capture, world.capture, "--images", images)
    print(text)
    assert code == 0, f"{images} images were recorded two seconds before: {text}"
