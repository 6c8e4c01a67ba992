"""What happens to the service: reloads, kills, threads that are stuck, second instances, a disk it may not touch."""

import shutil

from poses import assert_expected


def good_reload(world):
    """Another map takes the old one's place without a restart."""
    before = world.localize()
    world.locd.configure(map_file="other.map")
    world.guest.check("systemctl reload locd")
    after = world.hearing.wait_for("pose by the other map", "POSE",
                                   lambda m: m["map_hash"] != before["map_hash"] and m["cameras_used"] == 3)
    assert after["session"] == before["session"], "it was restarted"
    world.locd.configure()
    world.guest.check("systemctl reload locd")
    world.hearing.mark()
    world.hearing.wait_for("pose by the first map", "POSE", lambda m: m["map_hash"] == before["map_hash"])


def refused_reload(world):
    """A map that is damaged, too new, absent, a key unknown or that needs a restart: refused whole, said everywhere."""
    before = world.localize()
    for damage, word in (("head -c 3000 /share/etc/room.map >/etc/locd/room.map", "room.map"),
                         # The format's version is the ninth byte.
                         ("printf '\\143' | dd of=/etc/locd/room.map bs=1 seek=8 conv=notrunc 2>&1", "version 99"),
                         ("rm /etc/locd/room.map", "room.map"),
                         ("sed -i 's/^deadline_ms/dead_line_ms/' /etc/locd/locd.toml", "dead_line_ms"),
                         ("sed -i 's/^tolerance_us.*/tolerance_us = 1000/' /etc/locd/locd.toml", "[sync]")):
        world.guest.check(damage)
        world.hearing.mark()
        world.guest.run("systemctl reload locd")
        alert = world.hearing.wait_for("alert", "ALERT", lambda m: m["raised"] and m["kind"] == "RELOAD")
        assert word in alert["text"], alert
        world.hearing.wait_for("status that says why", "STATUS", lambda m, w=word: w in m["reload_refused"])
        assert word in world.guest.check("journalctl -q -u locd -o cat -n 30 | grep 'reload refused'")
        pose = world.wait_for_full_pose()
        assert pose["map_hash"] == before["map_hash"] and pose["session"] == before["session"], pose
        assert world.locd.show("ActiveState") == "active"
        world.locd.configure()
    assert "refused" in world.locd.show("StatusText"), world.locd.show("StatusText")
    world.guest.check("systemctl reload locd")
    world.hearing.mark()
    world.hearing.wait_for("that all is well", "STATUS", lambda m: m["reload_refused"] == "")


def killed_while_recording(world):
    """kill -9: started again by itself, and what was recorded is a capture."""
    session = world.localize()["session"]
    folder = world.locd.request("start").removeprefix("ok ")
    world.hearing.mark()
    world.hearing.wait_for("recording", "STATUS", lambda m: m["recorded_sets"] >= 3)
    restarts = int(world.locd.show("NRestarts"))
    world.guest.check("systemctl kill -s KILL locd")
    last = world.hearing.since_mark("STATUS")[-1]["recorded_sets"]
    world.hearing.mark()
    world.hearing.wait_for("pose of another session", "POSE",
                           lambda m: m["session"] != session and m["cameras_used"] == 3, timeout_s=90)
    assert int(world.locd.show("NRestarts")) == restarts + 1
    shutil.rmtree(world.share / "killed", ignore_errors=True)
    world.guest.check(f"cp -r {folder} /share/killed")
    code, text = world.native("compare_recording", world.share / "killed", world.capture, "--full", last - 1)
    assert code == 0, f"{last} sets were recorded: {text}"
    code, text = world.native("mapbuilder", "detect", world.share / "killed", "-o", world.run / "killed.csv")
    assert code == 0 and "skipped" not in text, text


# Instead of the 30 s that the unit has here: only of the process that a scenario holds.
WATCHDOG_S = 10


def stuck_thread(world):
    """The solving thread, or a camera's, hangs: the watchdog ends the service, systemd starts it again."""
    world.localize()
    for name in ("localization", "cam1"):
        session = world.wait_for_full_pose()["session"]
        pid = world.locd.pid()
        restarts = int(world.locd.show("NRestarts"))
        world.locd.note_time()
        # The first of its name; threads that it has begun bear the same.
        thread = world.guest.check(f"grep -lx {name} /proc/{pid}/task/*/comm | head -1").split("/")[4]
        # As the process itself may do it.
        world.guest.check(f"NOTIFY_SOCKET=/run/systemd/notify systemd-notify --pid={pid} WATCHDOG_USEC={WATCHDOG_S}000000")
        world.hearing.mark()
        world.guest.check("systemctl reset-failed holder 2>/dev/null; "
                          f"systemd-run --quiet --collect --unit=holder /share/bin/vm_hold_thread {thread}")
        world.hearing.wait_for("pose of another session", "POSE",
                               lambda m, s=session: m["session"] != s and m["cameras_used"] == 3, timeout_s=90)
        assert any("Watchdog timeout" in line for line in world.locd.lines_since()), world.locd.lines_since()
        assert int(world.locd.show("NRestarts")) == restarts + 1


def assert_steady(before, after, what):
    """utime went on between two poses as the clock did that nobody sets, in one process."""
    by_utime_s = (after["utime"] - before["utime"]) / 1e6
    by_stamp_s = (after["heard_s"] - after["latency_ms"] / 1e3) - (before["heard_s"] - before["latency_ms"] / 1e3)
    assert abs(by_utime_s - by_stamp_s) < 0.5, f"{what}: utime went on by {by_utime_s} s in {by_stamp_s} s"
    assert after["session"] == before["session"], f"{what}: it was restarted"


# s by which somebody sets the wall clock; None: to 1970, as if its battery were empty.
CLOCK_STEPS_S = (3600, -3600, 0.05, -0.05, None)


def clock_steps(world):
    """The wall clock is set: utime goes on as if nothing were; a TIME alert and a counter say it."""
    before = world.localize()
    world.hearing.mark()
    steps = world.hearing.wait_for("status", "STATUS", lambda m: True)["time_steps"]
    # What the clock should show is known by the one that nobody sets.
    offset = "$(awk -v now=$(date +%s.%N) '{ printf \"%.3f\", now - $1 }' /proc/uptime)"
    offset_s = float(world.guest.check(f"echo {offset}"))
    world.hearing.mark()
    try:
        for step_s in CLOCK_STEPS_S:
            # The kernel takes no date before its own boot.
            world.guest.check("date --set=@$(awk '{ print int($1) + 1000 }' /proc/uptime)" if step_s is None else
                              f"date --set=@$(awk -v now=$(date +%s.%N) 'BEGIN {{ printf \"%.6f\", now + {step_s} }}')")
            if step_s == CLOCK_STEPS_S[0]:  # once raised, it stays
                world.hearing.wait_for("TIME", "ALERT", lambda m: m["raised"] and m["kind"] == "TIME")
            steps = world.hearing.wait_for("counted step", "STATUS", lambda m, s=steps: m["time_steps"] > s)["time_steps"]
            after = world.wait_for_full_pose()
            assert_steady(before, after, f"a step of {step_s} s")
    finally:
        world.guest.check(f"date --set=@$(awk '{{ printf \"%.3f\", $1 + {offset_s} }}' /proc/uptime)")
        world.locd.stop()


def slept_s(world):
    """For how long the machine has slept since it was started."""
    return float(world.guest.check("perl -MTime::HiRes=clock_gettime,CLOCK_MONOTONIC -e "
                                   "'print clock_gettime(7) - clock_gettime(CLOCK_MONOTONIC)'"))  # 7: BOOTTIME


def suspend_and_resume(world):
    """The machine sleeps, its cameras without power: poses of all go on by the clock that did not count it; the
    log and a counter say so."""
    before = world.localize()
    world.hearing.mark()
    steps = world.hearing.wait_for("status", "STATUS", lambda m: True)["time_steps"]
    awake_s = slept_s(world)
    world.hearing.mark()
    try:
        world.suspend()
        took_s = slept_s(world) - awake_s
        assert took_s > 4, f"it slept for {took_s} s"
        world.hearing.wait_for("counted step", "STATUS", lambda m: m["time_steps"] > steps)
        world.wait_until("it says so", lambda: world.locd.has_said("clock was set or it slept"))
        after = world.wait_for_full_pose(count=3)[-1]
        assert_expected(world, after)
        assert_steady(before, after, "the sleep")
    finally:
        world.locd.stop()


def second_instance(world):
    """Refused with 69, naming the first's process."""
    world.localize()
    pid = world.locd.pid()
    code, text = world.guest.run("RUNTIME_DIRECTORY=/run/locd STATE_DIRECTORY=/var/lib/locd "
                                 "setpriv --reuid locd --regid locd --init-groups locd --config /etc/locd/locd.toml")
    assert code == 69 and f"pid {pid}" in text, f"exit code {code}: {text}"
    assert world.locd.pid() == pid


def writes_only_its_state(world):
    """Its own folders, cameras, multicast and this machine are all that its sandbox leaves, even to root."""
    world.localize()
    pid = world.locd.pid()
    inside = f"nsenter --target {pid} --mount --"
    written = world.guest.check(
        "for folder in / /etc /usr /usr/bin /var /var/log /var/lib /root /home /boot /srv /opt; do "
        f"{inside} touch $folder/waymark-was-here 2>/dev/null && echo $folder; done; "
        f"{inside} sh -c ': >>/sys/module/uvcvideo/parameters/clock' 2>/dev/null && echo /sys; true")
    assert written == "", f"can be written: {written}"
    as_locd = f"{inside} setpriv --reuid locd --regid locd --init-groups"
    assert world.guest.run(f"{as_locd} touch /etc/locd/waymark-was-here")[0] != 0, "it can write its configuration"
    for folder in ("/var/lib/locd", "/run/locd"):
        world.guest.check(f"{as_locd} touch {folder}/waymark-was-here && rm {folder}/waymark-was-here")
    owned = world.guest.check("find /dev /etc /home /opt /root /run /srv /tmp /var -user locd "
                              "-not -path '/var/lib/locd*' -not -path '/run/locd*'")
    assert owned == "", f"files elsewhere: {owned}"
    for way, allowed in (("</dev/vda", False), ("</dev/kmsg", False), (">/dev/udp/192.168.77.9/9", False),
                         ("</dev/waymark/WM-0", True), (">/dev/udp/239.255.76.67/9", True)):
        assert can(world, way), f"nobody can {way}"
        assert can(world, way, "locd.service") == allowed, f"{way} is {'refused' if allowed else 'allowed'}"


def can(world, way, unit=None):
    """Whether root can redirect like that in a shell of its own, or of a unit's control group; else it is not
    permitted."""
    join = f"echo $$ >/sys/fs/cgroup/system.slice/{unit}/cgroup.procs; " if unit else ""
    code, text = world.guest.run(f"bash -c '{join}{{ {':' if way[0] == '<' else 'echo'} {way}; }}'")
    assert code == 0 or "Operation not permitted" in text, text
    return code == 0
