"""Disks that are full, and power that is cut."""

import shutil
import subprocess

MOUNT = "/var/lib/locd/recordings"


def localize_with_disk(world):
    """Poses of all cameras; recordings go to the disk of their own. The session."""
    world.prepare()
    if world.guest.run(f"mountpoint -q {MOUNT}")[0] != 0:
        world.locd.stop()  # it does not see what is mounted later
        world.guest.check(f"mount /dev/vdb {MOUNT} && chown locd:locd {MOUNT}")
    return world.localize()["session"]


def disk_full(world):
    """Recording onto a full disk ends, is said, and leaves whole sets; poses go on."""
    session = localize_with_disk(world)
    # Room for some ten sets of three images with 330 kB each.
    world.guest.check(f"rm -rf {MOUNT}/*; free=$(df --output=avail -B1 {MOUNT} | tail -1); "
                      f"fallocate -l $((free - 10000000)) {MOUNT}/ballast")
    world.hearing.mark()
    folder = world.locd.request("start").removeprefix("ok ")
    # Without earlier recordings to delete the oldest sets go; the ballast keeps the disk full.
    world.hearing.wait_for("recording", "STATUS", lambda m: m["recorded_sets"] >= 3)
    world.guest.check(f"fallocate -l 100000000000 {MOUNT}/more 2>/dev/null; dd if=/dev/zero of={MOUNT}/rest bs=64k "
                      "2>/dev/null; true", 120)
    world.hearing.wait_for("alert that recording ended", "ALERT",
                           lambda m: m["raised"] and m["kind"] == "RECORDING", timeout_s=90)
    assert world.wait_for_full_pose()["session"] == session
    shutil.rmtree(world.share / "full", ignore_errors=True)
    world.guest.check(f"cp -r {folder} /share/full; rm -rf {MOUNT}/*")
    assert not list((world.share / "full").rglob(".*.part")), "a half-written image is left"


def failing_disk(world):
    """The disk fails while recording: the recording ends and it is said; poses go on."""
    session = localize_with_disk(world)
    world.hearing.mark()
    world.locd.request("start")
    world.hearing.wait_for("recording", "STATUS", lambda m: m["recorded_sets"] >= 2)
    world.hearing.mark()
    # What the kernel does when a disk gives an error: from now on it is read-only.
    world.guest.check(f"mount -o remount,errors=remount-ro {MOUNT} && echo 1 >/sys/fs/ext4/vdb/trigger_fs_error")
    world.hearing.wait_for("alert that recording ended", "ALERT",
                           lambda m: m["raised"] and m["kind"] == "RECORDING", timeout_s=90)
    assert world.wait_for_full_pose()["session"] == session
    world.locd.stop()
    world.guest.check(f"umount {MOUNT}")


def power_cut(world):
    """The power goes while recording: what lies on the disk is a capture that lacks a second at most."""
    localize_with_disk(world)
    folder = world.locd.request("start").removeprefix("ok ")
    world.hearing.mark()
    world.hearing.wait_for("recording", "STATUS", lambda m: m["recorded_sets"] >= 8, timeout_s=90)
    last = world.hearing.since_mark("STATUS")[-1]["recorded_sets"]
    world.machine.kill()
    disk = world.machine.recordings
    repaired = subprocess.run(["e2fsck", "-fy", disk], check=False, capture_output=True, text=True)
    assert repaired.returncode in (0, 1), repaired.stdout
    shutil.rmtree(world.run / "cut", ignore_errors=True)
    (world.run / "cut").mkdir()
    subprocess.run(["debugfs", "-R", f"rdump {folder.removeprefix(MOUNT)} {world.run / 'cut'}", disk], check=True,
                   capture_output=True)
    capture = next((world.run / "cut").iterdir())
    code, text = world.native("compare_recording", capture, world.capture)
    print(text)
    assert code == 0, text
    sets = int(text.split()[3])
    # One set a second; the status may be a second old, the disk another.
    assert sets >= last - 2, f"{sets} sets on the disk, {last} recorded"
