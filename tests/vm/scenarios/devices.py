"""What happens to cameras: unplugged, plugged in again, elsewhere, hanging, sending rubbish."""

import re
import statistics

import hearing as heard
from cameras import COUNT
from poses import assert_expected, assert_linked_and_awake, assert_set

# FAULTS: back within so many seconds of the udev event.
BACK_S = 5.0


def state_of(message, camera):
    return next(c for c in message["cameras"] if c["name"] == camera)


def udev_saw_s(world, serial):
    """When udev saw the camera's node come, on the guest's monotonic clock; None before it did."""
    code, text = world.guest.run(f"udevadm info -q property /dev/v4l/by-id/*_{serial}-video-index0")
    found = re.search(r"^USEC_INITIALIZED=(\d+)$", text, re.M)
    return int(found[1]) / 1e6 if code == 0 and found else None


def wait_for_udev(world, serial, timeout_s=60):
    return world.wait_until(f"udev sees {serial}", lambda: udev_saw_s(world, serial), timeout_s)


def unplug_and_replug(world):
    """One camera goes: poses of the others, DEGRADED, its name; it is back within 5 s of the udev event."""
    session = world.localize()["session"]
    world.hearing.mark()
    world.cameras[1].unplug()
    pose = world.hearing.wait_for(
        "pose of two cameras", "POSE",
        lambda m: m["cameras_used"] == COUNT - 1 and m["reasons"] & heard.CAMERA_MISSING)
    assert pose["status"] == heard.DEGRADED, pose
    world.hearing.wait_for("alert that names the camera", "ALERT",
                           lambda m: m["raised"] and m["kind"] == "MISSING" and m["subject"] == "cam1")
    world.hearing.wait_for("status that says so", "STATUS",
                           lambda m: state_of(m, "cam1")["state"] == heard.CAMERA_LOST and "cam1" in m["text"])

    def replug():
        world.cameras[1].unplug()
        world.hearing.wait_for("alert", "ALERT", lambda m: m["raised"] and m["kind"] == "MISSING")
        world.hearing.mark()
        world.cameras[1].plug(1)
        came_s = wait_for_udev(world, "WM-1")
        pose = world.hearing.wait_for("pose of all three", "POSE",
                                      lambda m: m["cameras_used"] == COUNT and m["heard_s"] > came_s)
        world.hearing.wait_for("end of the alert", "ALERT", lambda m: not m["raised"] and m["kind"] == "MISSING")
        assert pose["session"] == session, "it was restarted"
        # Exposed when, on the guest's clock: what solving takes says nothing in an emulated machine.
        return pose["heard_s"] - pose["latency_ms"] / 1e3 - came_s

    world.one_of_three("from udev's event to the first image in a set", BACK_S, replug)
    # That it was the event and not the next attempt, 5 s later at most.
    assert world.locd.has_said("a video device was plugged in"), "udev's events do not reach it"
    assert_set(world.cameras[1])
    assert_linked_and_awake(world, world.cameras[1])


# A camera with a loose plug: so often, ended and begun by the kernel, which is faster than a process.
FLAPS = 6


def flapping_camera(world):
    """A camera that comes and goes neither floods the log nor ends anything, and takes part again when it stays."""
    session = world.localize()["session"]
    device = world.guest.check("basename $(dirname $(grep -l WM-1 /sys/bus/usb/devices/*/serial))")
    world.locd.note_time()
    world.guest.check(f"for i in $(seq {FLAPS}); do for on in 0 1; do echo $on >/sys/bus/usb/devices/{device}/authorized; "
                      "sleep 0.3; done; done", 120)
    assert world.wait_for_full_pose()["session"] == session, "it was restarted"
    lines = world.locd.lines_since()
    assert len(lines) <= 2 * FLAPS, "\n".join(lines)
    assert_set(world.cameras[1])


def all_unplugged_and_replugged_elsewhere(world):
    """Without a camera LOST goes on twice a second; plugged into other ports the cameras are who they were."""
    session = world.localize()["session"]
    for camera in world.cameras:
        camera.unplug()
    world.hearing.mark()
    world.hearing.wait_for("LOST without frames", "POSE",
                           lambda m: m["status"] == heard.LOST and m["reasons"] & heard.NO_FRAMES)

    def gap_s():
        world.hearing.mark()
        lost = world.hearing.wait_for("LOST messages", "POSE", lambda m: m["status"] == heard.LOST, count=10)
        assert all(v is None for m in lost for v in m["position"]), "a pose in LOST"
        return statistics.median(b["heard_s"] - a["heard_s"] for a, b in zip(lost, lost[1:]))

    world.one_of_three("between LOST messages", 0.5, gap_s)
    # 0, 1, 2 into ports 2, 0, 1, so that every number changes.
    for number in (1, 2, 0):
        world.cameras[number].plug((number + 2) % COUNT)
        wait_for_udev(world, f"WM-{number}")
    for message in world.wait_for_full_pose(count=3):
        assert_expected(world, message)
        assert message["session"] == session, "it was restarted"
    for number in range(COUNT):
        world.cameras[number].plug(number)
    for number in range(COUNT):
        wait_for_udev(world, f"WM-{number}")
    world.wait_for_full_pose()


def assert_started_again(world, number):
    """A camera that delivers nothing is named and its stream started again, until it delivers."""
    name = f"cam{number}"
    world.hearing.mark()
    world.cameras[number].order("stall")
    world.hearing.wait_for("alert that names the camera", "ALERT",
                           lambda m: m["raised"] and m["kind"] == "MISSING" and m["subject"] == name)
    starts = state_of(world.hearing.since_mark("STATUS")[0], name)["starts"]
    world.hearing.wait_for("restart of the stream", "STATUS", lambda m: state_of(m, name)["starts"] > starts)
    world.cameras[number].order("go")
    world.wait_for_full_pose()


def hanging_camera(world):
    """A camera without frames is named and started again, and again, until it delivers."""
    world.localize()
    assert_started_again(world, 2)


def short_frames(world):
    """Frames that end half-way are dropped and counted, those of the other cameras used."""
    world.localize()
    # As it comes, uvcvideo keeps damaged frames to itself; it decides so when a camera is plugged in.
    nodrop = "/sys/module/uvcvideo/parameters/nodrop"
    world.guest.check(f"echo 1 >{nodrop}")
    try:
        world.cameras[0].plug(0)
        wait_for_udev(world, "WM-0")
        world.wait_for_full_pose()
        world.hearing.mark()
        damaged = world.hearing.wait_for("status", "STATUS", lambda m: True)["drops"]["damaged"]
        world.cameras[0].order("short 1000")
        world.hearing.wait_for("drops", "STATUS", lambda m: m["drops"]["damaged"] >= damaged + 2)
        world.hearing.wait_for("poses of the others", "POSE", lambda m: m["cameras_used"] == COUNT - 1)
    finally:
        world.guest.check(f"echo 0 >{nodrop}")
        world.cameras[0].unplug()
    world.plug_all()
    world.wait_for_full_pose()


def assert_named_and_left_out(world, order, kind):
    """What cam0 shows after the order is named so, and poses do without it."""
    world.hearing.mark()
    world.cameras[0].order(order)
    world.hearing.wait_for(kind, "ALERT", lambda m: m["raised"] and m["kind"] == kind and m["subject"] == "cam0")
    world.hearing.wait_for("poses without it", "POSE", lambda m: m["cameras_used"] == COUNT - 1)


def assert_used_again(world, kind):
    """After "go" the alert ends and cam0 takes part."""
    world.cameras[0].order("go")
    world.hearing.wait_for("its end", "ALERT", lambda m: not m["raised"] and m["kind"] == kind)
    world.wait_for_full_pose()


def frozen_sensor(world):
    """A camera that repeats its image is named FROZEN and left out."""
    world.localize()
    assert_named_and_left_out(world, "freeze", "FROZEN")
    assert_used_again(world, "FROZEN")


def useless_images(world):
    """Nothing but black, white or grey: named DARK, SATURATED, OBSCURED, and left out until there are images again."""
    world.localize()
    for grey, kind in ((0, "DARK"), (255, "SATURATED"), (128, "OBSCURED")):
        assert_named_and_left_out(world, f"paint {grey}", kind)
    assert_used_again(world, "OBSCURED")


def truncated_jpegs(world):
    """A camera that sends JPEGs gives the same poses; those that end half-way are dropped and counted."""
    world.localize()
    world.cameras[2].plug(2, mjpeg=True)
    try:
        wait_for_udev(world, "WM-2")
        for message in world.wait_for_full_pose(count=3):
            assert_expected(world, message)
        world.hearing.mark()
        damaged = world.hearing.wait_for("status", "STATUS", lambda m: True)["drops"]["damaged"]
        world.cameras[2].order("short 1000")
        world.hearing.wait_for("drops", "STATUS", lambda m: m["drops"]["damaged"] >= damaged + 2)
        world.hearing.wait_for("poses of the others", "POSE", lambda m: m["cameras_used"] == COUNT - 1)
    finally:
        world.cameras[2].unplug()
    world.plug_all()
    world.wait_for_full_pose()


def stamps_of_another_clock(world):
    """Stamps in the far future are refused and counted; as they go on, poses rest on arrival and say UNSYNCED."""
    world.localize()
    clock = "/sys/module/uvcvideo/parameters/clock"
    world.hearing.mark()
    bad = world.hearing.wait_for("status", "STATUS", lambda m: True)["drops"]["bad_stamp"]
    # The driver goes on saying that its stamps are of the monotonic clock.
    world.guest.check(f"printf CLOCK_REALTIME >{clock}")
    try:
        world.hearing.wait_for("refused frames", "STATUS", lambda m: m["drops"]["bad_stamp"] >= bad + COUNT)
        world.hearing.wait_for("UNSYNCED", "ALERT",
                               lambda m: m["raised"] and m["kind"] == "UNSYNCED" and m["subject"] == "cam0")
        pose = world.hearing.wait_for("poses that say so", "POSE",
                                      lambda m: m["reasons"] & heard.UNSYNCED and m["cameras_used"] == COUNT)
        assert_expected(world, pose)
    finally:
        world.guest.check(f"printf CLOCK_MONOTONIC >{clock}")
        world.locd.stop()  # stamps are believed again after fifty good ones only


# Prints how long a process goes on after SIGTERM, s; one process, for each takes tenths of a second here.
END_IT = """use Time::HiRes qw(time sleep); my $began = time; kill TERM => $ARGV[0];
    while (open my $file, "<", "/proc/$ARGV[0]/status") { local $/; last if <$file> =~ /^State:\\s+Z/m; sleep 0.01 }
    print time - $began;"""


def blocking_device(world):
    """A device whose calls do not return holds up neither poses nor the end."""
    world.localize()

    def end_s():
        world.cameras[1].order("stall")
        world.cameras[1].order("mute")  # the restart that follows blocks in the kernel
        world.hearing.mark()
        world.hearing.wait_for("poses of the others", "POSE", lambda m: m["cameras_used"] == COUNT - 1, count=3)
        world.wait_until("its thread is stuck in a call", lambda: world.locd.has_said("does not turn"))
        world.hearing.mark()
        world.hearing.wait_for("poses while it is", "POSE", lambda m: m["cameras_used"] == COUNT - 1)
        # The program ends; what its thread waits for in the kernel (uvcvideo: up to 5 s) keeps the rest of the
        # process, of which nothing runs any more.
        took_s = float(world.guest.check(f"perl -e '{END_IT}' {world.locd.pid()}", 60))
        world.cameras[1].plug(1)
        wait_for_udev(world, "WM-1")
        world.localize()
        return took_s

    world.one_of_three("from SIGTERM to the end", STOP_S, end_s)


# FAULTS.
STOP_S = 1.0


def settings_of_others(world):
    """Another program can't set a camera that is locd's: the kernel refuses it, and one that claims as much priority, too.
    (What a driver without priorities lets through is held by V4l2SourceTest.)"""
    world.localize()
    for claim in ("", "--set-priority=3"):
        code, said = world.guest.run(f"v4l2-ctl -d /dev/waymark/WM-0 {claim} --set-ctrl=gain=100 2>&1")
        assert code != 0 and "busy" in said, (claim, code, said)
        assert_set(world.cameras[0])
    world.localize()
    assert not world.locd.has_said("was set from")
