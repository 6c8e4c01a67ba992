"""From the cameras' pixels to poses, recordings and back."""

import shutil

from world import pose_distance, read_tum


def assert_expected(world, message):
    """A pose lies where the images put it; the cameras' skew moves it by a few millimetres."""
    metres, degrees = world.distance_to_expected(message)
    assert metres < 0.01 and degrees < 0.3, f"{metres} m, {degrees} deg off: {message}"


def no_route_at_boot(world):
    """Without any route for multicast locd runs and counts; with one it sends, under the unit's address filter."""
    world.plug_all()
    world.locd.configure()
    assert world.guest.run("ip route show table all to 239.255.76.67")[1] == ""
    world.locd.start()
    world.guest.check("journalctl -q -u locd -o cat | grep -q 'route for multicast'")
    world.listen()
    world.hearing.wait_for("status", "STATUS", lambda m: m["publish_failures"] > 0, timeout_s=30)
    world.wait_for_full_pose()
    assert world.locd.show("NRestarts") == "0"


def route_lost(world):
    """The way for multicast goes: messages are counted, nothing fails; it is back: so are they."""
    world.localize()
    session = world.wait_for_full_pose()["session"]
    world.hearing.mark()
    failures = world.hearing.wait_for("status", "STATUS", lambda m: True)["publish_failures"]
    world.guest.check("ip link set dummy0 down")
    # Silence tells nothing of how it is; some messages fall into it.
    world.guest.check("sleep 5")
    world.guest.check("ip link set dummy0 up && ip route add default via 192.168.77.2 dev dummy0")
    world.hearing.mark()
    world.hearing.wait_for("status", "STATUS", lambda m: m["publish_failures"] > failures)
    assert world.wait_for_full_pose()["session"] == session


def three_cameras(world):
    """Poses rest on all three cameras, are where the images put them, and the cameras are set as configured."""
    world.localize()
    for message in world.wait_for_full_pose(count=5):
        assert_expected(world, message)
    for camera in world.cameras:
        status = camera.order("status")
        for wanted in ('"auto_exposure":1', '"exposure_100us":30', '"gain":40'):
            assert wanted in status, f"{camera.serial}: {wanted} is not in {status}"


def recording(world):
    """What is recorded equals, pixel by pixel, what the cameras showed; each set is of one instant."""
    world.localize()
    folder = world.locd.request("start").removeprefix("ok ")
    world.hearing.mark()
    world.hearing.wait_for("recording of 12 sets", "STATUS", lambda m: m["recorded_sets"] >= 12, timeout_s=120)
    assert world.locd.request("stop").startswith("ok")
    shutil.rmtree(world.share / "recording", ignore_errors=True)
    world.guest.check(f"cp -r {folder} /share/recording", 120)
    code, text = world.native("compare_recording", world.share / "recording", world.capture)
    print(text)
    assert code == 0, text


def replay(world):
    """The recording gives the same poses, bit by bit, each time, and natively the same but for rounding."""
    guest = world.guest
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
