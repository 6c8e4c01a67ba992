"""Other ways from a camera to locd: libcamera, multi-planar and YUYV formats, v4l2loopback at full rate."""

import contextlib
import re

import hearing as heard
from cameras import COUNT
from devices import assert_started_again, state_of, wait_for_udev
from poses import assert_expected, assert_set

WIDTH, HEIGHT = 640, 480
# FourCC, our name, whether the device speaks multi-planar, and how its first plane holds luma.
FORMATS = (("YUYV", "YUYV", False, 2), ("YUYV", "YUYV", True, 2), ("NV12", "NV12", True, 1))
# In the camera's unit for libcamera's factor of 2: 1 is the default, 16, and 4 the highest, 255.
LIBCAMERA_GAIN = 96


def libcamera(world):
    """The same cameras through libcamera: poses of all three, where the images put them, cameras set as configured;
    one that hangs is started again, one that is unplugged is named, and used again when it is back."""
    world.prepare()
    world.locd.stop()
    world.guest.check("dpkg -i /share/waymark-libcamera.deb", timeout_s=120)
    for camera in world.cameras:
        camera.unplug()  # for settings of its own
    world.prepare()
    # libcamera's gain is a factor, and it sets no frame rate of USB cameras.
    world.locd.configure(driver="libcamera", gain=2, fps="")
    world.locd.start()
    try:
        for message in world.wait_for_full_pose(count=3):
            assert_expected(world, message)
        for camera in world.cameras:
            assert_set(camera, gain=LIBCAMERA_GAIN)
        checked = world.guest.check("locd --config /etc/locd/locd.toml --check", 120)
        assert checked.count("in use by the running locd") == COUNT, checked
        assert_started_again(world, 2)
        assert_used_again_when_back(world)
    finally:
        world.locd.stop()


def assert_used_again_when_back(world):
    """A camera that is unplugged is named, poses do without it; plugged in again it is used, and set as configured."""
    session = world.wait_for_full_pose()["session"]
    world.guest.check("dmesg --clear")
    world.hearing.mark()
    world.cameras[1].unplug()
    world.hearing.wait_for("alert that names the camera", "ALERT",
                           lambda m: m["raised"] and m["kind"] == "MISSING" and m["subject"] == "cam1")
    world.hearing.wait_for("poses of the others", "POSE", lambda m: m["cameras_used"] == COUNT - 1)
    world.hearing.wait_for("status that says so", "STATUS", lambda m: state_of(m, "cam1")["state"] == heard.CAMERA_LOST)
    world.cameras[1].plug(1)
    wait_for_udev(world, "WM-1")
    if world.wait_for_full_pose()["session"] != session:
        # libcamera 0.0.3 keeps a pointer to what it has freed, and follows it when the kernel tells of the same
        # node again before it tells of its media device. Then systemd starts locd again; nothing else may end it.
        died = world.guest.run("dmesg | grep segfault")[1]
        assert "in libcamera.so" in died, f"it was restarted: {died}"
        print("libcamera crashed, and locd was started again:", died)
    assert_set(world.cameras[1], gain=LIBCAMERA_GAIN)


def other_formats(world):
    """YUYV and NV12, single- and multi-planar, give the luma that v4l2-ctl gets of the same picture; buffers with an error are dropped."""
    guest = world.guest
    world.locd.quiet()
    guest.check("modprobe vivid n_devs=2 node_types=0x1,0x1 multiplanar=1,2 && udevadm settle", 60)
    nodes = [guest.check(f"v4l2-ctl --list-devices | grep -A1 'platform:vivid-00{i}' | tail -1").strip()
             for i in (0, 1)]
    for node in nodes:
        # A picture that stands still.
        guest.check(f"v4l2-ctl -d {node} --set-ctrl=osd_text_mode=2")
    for fourcc, name, multiplanar, bytes_per_luma in FORMATS:
        node = nodes[multiplanar]
        guest.check(f"v4l2-ctl -d {node} --set-fmt-video=width={WIDTH},height={HEIGHT},pixelformat={fourcc}"
                    " --stream-mmap --stream-count=1 --stream-to=/share/reference.raw", 60)
        guest.check(f"/share/bin/vm_capture bus=platform:vivid-00{int(multiplanar)} --width {WIDTH} "
                    f"--height {HEIGHT} --format {name} --frames 3 --save /share/captured.pgm", 60)
        luma = (world.share / "reference.raw").read_bytes()[: WIDTH * HEIGHT * bytes_per_luma: bytes_per_luma]
        captured = (world.share / "captured.pgm").read_bytes()[-WIDTH * HEIGHT:]
        assert len(luma) == WIDTH * HEIGHT and len(set(luma)) > 4, "v4l2-ctl gave no picture"
        differing = sum(a != b for a, b in zip(luma, captured))
        assert differing == 0, f"{name}, multiplanar {multiplanar}: {differing} pixels differ"
    # Kept by vivid until there is a buffer to flag.
    code, text = guest.run(f"v4l2-ctl -d {nodes[0]} --set-ctrl=inject_v4l2_buf_flag_error=1; "
                           f"/share/bin/vm_capture bus=platform:vivid-000 --width {WIDTH} --height {HEIGHT} "
                           "--format YUYV --frames 3", 60)
    assert code == 1 and "3 frames" in text and "1 damaged" in text, f"exit code {code}: {text}"
    guest.check("rmmod vivid")


# What an emulated computer feeds and reads three times 30 times a second; beside much other work only the less.
FED_SIZES = ((320, 240), (160, 120), (80, 60))
# How often to look, with each, for ten seconds in which the machine keeps pace.
ATTEMPTS = 3
FED_NUMBERS = (40, 41, 42)


def thirty_frames_a_second(world):
    """Three devices at 30 frames a second: the driver alone loses none."""
    world.locd.quiet()
    assert any(captured_at_full_rate(world, *size) for size in FED_SIZES), "never 30 frames a second"


def captured_at_full_rate(world, width, height):
    """Whether three devices gave 30 frames a second of this size; that none was lost is held in any case."""
    links = " ".join(f"bus=platform:v4l2loopback-{i:03}" for i in range(COUNT))
    with feeding(world, width, height):
        for _ in range(ATTEMPTS):
            # A machine with much other work may feed more slowly; that proves nothing, and none may be lost then either.
            text = world.guest.check(f"chrt --fifo 40 taskset --cpu-list 1 /share/bin/vm_capture {links} --width {width}"
                                     f" --height {height} --numbered --frames 300", 120)
            print(text, flush=True)
            gaps_ms = [float(gap) for gap in re.findall(r"frames, ([\d.]+) ms", text)]
            assert len(gaps_ms) == COUNT
            if all(32 < gap < 35 for gap in gaps_ms):
                return True
    return False


@contextlib.contextmanager
def feeding(world, width, height):
    """Three v4l2loopback devices that are fed 30 frames a second."""
    guest = world.guest
    # v4l2loopback 0.12.7 corrupts its list of buffers when a reader asks for fewer than there are while
    # somebody writes: as many as the driver asks for.
    guest.check(f"modprobe v4l2loopback devices={COUNT} video_nr={','.join(map(str, FED_NUMBERS))} "
                "exclusive_caps=0,0,0 max_buffers=6 card_label=wm0,wm1,wm2 && udevadm settle", 60)
    nodes = [f"/dev/video{number}" for number in FED_NUMBERS]
    try:
        # Whatever max_buffers says, it forgets all but the newest frame when its reader is three behind. Both on
        # one processor, the reader first as with [service] realtime: what holds one up holds up the other.
        guest.check("systemctl reset-failed feed 2>/dev/null; "
                    "systemd-run --quiet --unit=feed --property=CPUAffinity=1 "
                    f"/share/bin/vm_feed {width} {height} 30 {' '.join(nodes)}")
        # The devices offer no format to capture before one is fed.
        world.wait_until("feed feeds", lambda: all(
            f"{width}/{height}" in guest.run(f"v4l2-ctl -d {node} --get-fmt-video")[1] for node in nodes))
        yield
        print("times that the machine stood still:",
              guest.run("journalctl -q -o cat -u feed | grep -c 'stood still'")[1])
    finally:
        guest.run("systemctl stop feed; rmmod v4l2loopback")
