"""How locd starts: without a camera, with the wrong one, in real time; what it says about cameras."""

import re


def start_without_a_camera(world):
    """A camera that is not there never fails the start: after startup_wait_s it is ready and names it."""
    world.prepare()
    world.locd.stop()
    world.cameras[1].unplug()
    world.locd.configure(startup_wait_s=5)
    world.locd.start()  # returns when it is ready
    world.hearing.mark()
    world.hearing.wait_for("poses of the others", "POSE", lambda m: m["cameras_used"] == 2)
    world.wait_until("STATUS names it", lambda: "cam1" in world.locd.show("StatusText"))
    world.locd.stop()


def wrong_camera(world):
    """A camera in another's place refuses the start with 78, once, and names both; only a change mends it."""
    world.prepare()
    world.locd.stop()
    world.locd.configure(devices=("serial=WM-1", "serial=WM-0", "serial=WM-2"))
    world.guest.run("systemctl reset-failed locd; systemctl start locd", timeout_s=120)
    world.wait_until("it has failed", lambda: world.locd.show("ActiveState") == "failed")
    assert world.locd.show("ExecMainStatus") == "78" and world.locd.show("NRestarts") == "0"
    said = world.locd.journal()
    assert "WM-0" in said and "WM-1" in said, said


def realtime(world):
    """With the drop-in, threads run in real time with all memory locked; cameras named by link, port and serial
    number; poses come."""
    world.prepare()
    with world.locd.realtime_drop_in():
        port = world.guest.check("v4l2-ctl -d /dev/waymark/WM-1 --info | sed -n 's/.*Bus info *: *//p' | head -1")
        assert port.startswith("usb-"), port
        world.locd.configure(realtime=True, lock_memory=True,
                             devices=("/dev/waymark/WM-0", f"bus={port}", "serial=WM-2"))
        world.locd.start()
        world.wait_for_full_pose()
        threads = world.guest.check(f"ps -L -o comm=,cls=,rtprio= -p {world.locd.pid()}")
        of = dict(re.findall(r"^(\S+) +FF +(\d+)$", threads, re.M))
        assert of == {"cam0": "40", "cam1": "40", "cam2": "40", "localization": "30", "detection": "30"}, threads
        status = world.guest.check(f"cat /proc/{world.locd.pid()}/status")
        of_kb = {kind: int(kb) for kind, kb in re.findall(r"^Vm(Size|Lck):\s+(\d+) kB$", status, re.M)}
        # The cameras' buffers are the kernel's own, and never swapped out.
        assert of_kb["Lck"] > 0.9 * of_kb["Size"], of_kb
        world.locd.stop()


def list_and_check(world):
    """--list-cameras prints a block for each; --check knows a running locd as their owner, and tries them without."""
    world.localize()
    listed = world.guest.check("locd --list-cameras")
    assert sorted(re.findall(r'''^device = ["']serial=(.*)["']$''', listed, re.M)) == ["WM-0", "WM-1", "WM-2"], listed
    check = "locd --config /etc/locd/locd.toml --check"
    checked = world.guest.check(check)
    assert checked.count(f"in use by the running locd (pid {world.locd.pid()})") == 3, checked
    world.locd.stop()
    checked = world.guest.check(check, 120)
    assert checked.count("gain 40") == 3 and "all is well" in checked, checked
