"""From the cameras' pixels to poses, recordings and back."""

import contextlib
import shutil

from cameras import COUNT
from service import URL
from world import pose_distance, read_tum


def assert_expected(world, message):
    """A pose lies where the images put it; the cameras' skew moves it by a few millimetres."""
    metres, degrees = world.distance_to_expected(message)
    assert metres < 0.01 and degrees < 0.3, f"{metres} m, {degrees} deg off: {message}"


def no_route_at_boot(world):
    """Enabled, it starts with the system; without any route for multicast it runs and counts, with one it sends."""
    world.install()
    world.stop_listening()
    world.plug_all()
    world.locd.stop()
    world.locd.configure()
    # All that a boot does with an enabled unit; there is one in disks.power_back.
    world.guest.check("systemctl enable --quiet locd && systemctl start --no-block multi-user.target")
    world.wait_until("it is started", lambda: world.locd.show("ActiveState") == "active")
    world.wait_until("the log says why nothing is heard", lambda: world.locd.has_said("there is no route to"))
    world.listen()
    world.hearing.wait_for("status", "STATUS", lambda m: m["publish_failures"] > 0, timeout_s=30)
    world.wait_for_full_pose()
    assert world.locd.show("NRestarts") == "0"


def route_lost(world):
    """The way for multicast goes: messages are counted, nothing fails; it is back: so are they."""
    session = world.localize()["session"]
    world.hearing.mark()
    failures = world.hearing.wait_for("status", "STATUS", lambda m: True)["publish_failures"]
    world.guest.check("ip link set dummy0 down")
    world.wait_until("systemd's STATUS says it", lambda: "LCM" in world.locd.show("StatusText"))
    world.guest.check("ip link set dummy0 up && ip route add default via 192.168.77.2 dev dummy0")
    world.hearing.mark()
    world.hearing.wait_for("status", "STATUS", lambda m: m["publish_failures"] > failures)
    assert world.wait_for_full_pose()["session"] == session


@contextlib.contextmanager
def small_send_buffers(world):
    """Sockets made meanwhile are full after a few packets, not after half a minute of this machine's."""
    was = world.guest.check("sysctl -n net.core.wmem_default")
    world.guest.check("sysctl -qw net.core.wmem_default=9216")
    try:
        yield
    finally:
        world.guest.check(f"sysctl -qw net.core.wmem_default={was}")


STALL = "tc qdisc add dev dummy0 root tbf rate 1kbit burst 2000 limit 10mb"


def stalled_network(world):
    """The interface takes no packets: messages are lost, counted and said; requests are answered, the watchdog is fed;
    then they leave again, and it is said how many did not."""
    world.prepare()
    world.locd.stop()
    world.locd.configure(url=URL.replace("ttl=0", "ttl=1"))
    try:
        with small_send_buffers(world):
            world.locd.start()
        session = world.wait_for_full_pose()["session"]
        restarts = world.locd.show("NRestarts")
        world.guest.check(f"modprobe sch_tbf && {STALL}")
        world.wait_until("systemd's STATUS says it", lambda: "LCM takes no messages" in world.locd.show("StatusText"))
        assert world.locd.has_said("the network takes no packets")
        assert world.locd.request("status").startswith("ok")
        world.guest.check("tc qdisc del dev dummy0 root")
        world.wait_until("that it is over is said", lambda: world.locd.has_said("LINK is over"))
        assert world.wait_for_full_pose()["session"] == session and world.locd.show("NRestarts") == restarts
    finally:
        world.guest.run("tc qdisc del dev dummy0 root")
        world.locd.stop()


def three_cameras(world):
    """Poses rest on all three cameras, are where the images put them, and the cameras are set as configured."""
    world.localize()
    for message in world.wait_for_full_pose(count=5):
        assert_expected(world, message)
    for camera in world.cameras:
        assert_set(camera)
        assert_linked_and_awake(world, camera)


def assert_set(camera, gain=40):
    """The camera's controls are as configured."""
    status = camera.order("status")
    for wanted in ('"auto_exposure":1', '"exposure_100us":30', f'"gain":{gain}'):
        assert wanted in status, f"{camera.serial}: {wanted} is not in {status}"


def assert_linked_and_awake(world, camera):
    """The package's udev rules: a link by the serial number, and no sleep between frames."""
    link = f"/dev/waymark/{camera.serial}"
    seen = world.guest.check(f"readlink {link}; udevadm info -q property --property=ID_SERIAL_SHORT --value {link}; "
                             f"cat /sys/class/video4linux/$(basename $(readlink {link}))/device/../power/control")
    assert seen.split()[1:] == [camera.serial, "on"] and seen.startswith("../video"), f"{camera.serial}: {seen}"


def start_recording(world):
    """The folder of a recording that begins; statuses are marked from its first on."""
    answer = world.locd.request("start")
    assert answer.startswith("ok /"), answer
    folder = answer.removeprefix("ok ")
    world.hearing.mark()
    world.hearing.wait_for("status of the recording", "STATUS", lambda m: m["recording_path"] == folder)
    world.hearing.mark()
    return folder


# Of a recorded image, but for its header and its row in the table, a thousandth of it.
IMAGE_BYTES = 400 * 320


def images_recorded(status):
    """How many images the recording holds: sets may lack some, for cameras that stand still leave frames out."""
    return status["recorded_bytes"] // IMAGE_BYTES


def full_sets_recorded(status):
    """How many of its sets are of all cameras at least, however few images the others hold."""
    return images_recorded(status) - (COUNT - 1) * status["recorded_sets"]


def recording(world):
    """What is recorded equals, pixel by pixel, what the cameras showed; each set is of one instant."""
    world.localize()
    folder = start_recording(world)
    last = world.hearing.wait_for("recording of 12 whole sets", "STATUS", lambda m: full_sets_recorded(m) >= 12,
                                  timeout_s=120)
    assert world.locd.request("stop").startswith("ok")
    shutil.rmtree(world.share / "recording", ignore_errors=True)
    world.guest.check(f"cp -r {folder} /share/recording", 120)
    code, text = world.native("compare_recording", world.share / "recording", world.capture, "--full", 12, "--images",
                              images_recorded(last))
    print(text)
    assert code == 0, text


def replay(world):
    """The recording gives the same poses, bit by bit, each time, and natively the same but for rounding."""
    guest = world.guest
    if not (world.share / "recording").is_dir():
        recording(world)
    world.locd.stop()  # both would take twice as long
    shutil.copy(world.capture.parent / "room.map", world.share / "room.map")
    for run in (1, 2):
        guest.check(f"locd --replay /share/recording --map /share/room.map --trajectory /share/guest{run}.tum "
                    f"--table /share/guest{run}.csv", timeout_s=240)
    for kind in ("tum", "csv"):
        first, second = ((world.share / f"guest{run}.{kind}").read_bytes() for run in (1, 2))
        assert first == second and first, f"two replays differ in .{kind}"
    native = world.run / "native.tum"
    code, text = world.native("locd", "--replay", world.share / "recording", "--map", world.share / "room.map",
                              "--trajectory", native)
    assert code == 0, text
    mine = {stamp: pose for stamp, *pose in read_tum(world.share / "guest1.tum")}
    theirs = {stamp: pose for stamp, *pose in read_tum(native)}
    assert len(mine) >= 10, f"{len(mine)} poses only"
    agree = 0
    for stamp, pose in mine.items():
        metres, degrees = pose_distance(pose, theirs[stamp]) if stamp in theirs else (1, 180)
        agree += metres <= 1e-4 and degrees <= 0.002
    print(f"{agree} of {len(mine)} poses agree natively within 0.1 mm and 0.002 deg")
    assert agree >= 0.99 * max(len(mine), len(theirs)), f"{agree} of {len(mine)} and {len(theirs)}"
