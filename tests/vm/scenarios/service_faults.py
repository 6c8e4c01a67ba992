"""What happens to the service: reloads, kills, threads that are stuck, second instances, a disk it may not touch."""

import shutil

import hearing as heard
from poses import assert_expected, images_recorded, start_recording
from steady_utime import SteadyUtime, slew_s


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
    folder = start_recording(world)
    world.hearing.wait_for("recording", "STATUS", lambda m: m["recorded_sets"] >= 3)
    restarts = int(world.locd.show("NRestarts"))
    world.guest.check("systemctl kill -s KILL locd")
    last = world.hearing.since_mark("STATUS")[-1]
    world.hearing.mark()
    world.hearing.wait_for("pose of another session", "POSE",
                           lambda m: m["session"] != session and m["cameras_used"] == 3, timeout_s=90)
    assert int(world.locd.show("NRestarts")) == restarts + 1
    shutil.rmtree(world.share / "killed", ignore_errors=True)
    world.guest.check(f"cp -r {folder} /share/killed")
    code, text = world.native("compare_recording", world.share / "killed", world.capture, "--images",
                              images_recorded(last))
    assert code == 0, f"{images_recorded(last)} images were recorded: {text}"
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


# The kernel's own way to set the clock by so much and no more, however long the command takes: adjtimex with
# ADJ_SETOFFSET, s and us.
STEP_CLOCK = """perl -e 'my $timex = pack("L x4 x64 q q x120", 0x100, @ARGV); syscall(159, $timex) >= 0 or die "$!"'"""


def step_clock(world, step_s):
    seconds, us = divmod(round(step_s * 1e6), 1_000_000)
    world.guest.check(f"{STEP_CLOCK} -- {seconds} {us}")


# s by which somebody sets the wall clock; None: to 1970, as if its battery were empty.
CLOCK_STEPS_S = (3600, -3600, 0.05, -0.05, None)
# The kernel takes no date before its own boot.
TO_1970 = "echo $(($(cut -d. -f1 /proc/uptime) + 1000 - $(date +%s)))"


def clock_steps(world):
    """The wall clock is set: utime goes on as if nothing were; a TIME alert, a counter and its error say it."""
    world.localize()
    utime = SteadyUtime(world)
    before = utime.first
    off_s = 0
    try:
        for step_s in CLOCK_STEPS_S:
            step_s = step_s or float(world.guest.check(TO_1970))
            world.hearing.mark()
            step_clock(world, step_s)
            off_s += step_s
            if step_s == CLOCK_STEPS_S[0]:  # once raised, it stays
                world.hearing.wait_for("TIME", "ALERT", lambda m: m["raised"] and m["kind"] == "TIME")
            # Once set back, it has not much to catch up with.
            wanted = {heard.TIME_STEPPED} if abs(off_s) > 0.01 else {heard.TIME_OK, heard.TIME_STEPPED}
            before = world.hearing.wait_for(
                f"status that counts a step of {step_s} s", "STATUS",
                lambda m, b=before, s=step_s, w=wanted: m["time_steps"] > b["time_steps"] and m["time_status"] in w and
                abs(m["time_error_s"] - b["time_error_s"] - s) < slew_s(b, m))
            utime.check()
    finally:
        step_clock(world, -off_s)
        world.locd.stop()


def slept_s(world):
    """For how long the machine has slept since it was started; the most of several looks, for the machine may stand
    still between two clocks."""
    return float(world.guest.check("perl -MTime::HiRes=clock_gettime,CLOCK_MONOTONIC -e '"
                                   "for (1..9) { $_ = clock_gettime(7) - clock_gettime(CLOCK_MONOTONIC); "  # 7: BOOTTIME
                                   "$most = $_ if !defined $most || $_ > $most } print $most'"))


def suspend_and_resume(world):
    """The machine sleeps, its cameras without power: poses of all go on by the clock that did not count it; the
    log and a counter say so."""
    world.localize()
    utime = SteadyUtime(world)
    before = utime.first
    awake_s = slept_s(world)
    world.hearing.mark()
    try:
        world.suspend()
        took_s = slept_s(world) - awake_s
        assert took_s > 4, f"it slept for {took_s} s"
        world.hearing.wait_for("status that counts the sleep", "STATUS",
                               lambda m: m["time_steps"] > before["time_steps"] and
                               m["time_status"] == heard.TIME_SUSPENDED and
                               abs(m["time_error_s"] - before["time_error_s"] - took_s) < slew_s(before, m) + 1)
        world.wait_until("it says so", lambda: world.locd.has_said("clock was set or it slept"))
        assert_expected(world, world.wait_for_full_pose(count=3)[-1])
        utime.check()
    finally:
        world.locd.stop()


def tried_again(world):
    """A start while the map is still being copied fails with 65, visibly, and goes well by itself once it is whole; whom
    somebody ends comes back; whom systemctl stops stays away."""
    world.prepare()
    world.locd.stop()
    world.locd.configure()
    world.guest.check("head -c 3000 /share/etc/room.map >/etc/locd/room.map")
    assert world.guest.run("systemctl reset-failed locd; systemctl start locd", timeout_s=120)[0] != 0
    assert world.locd.show("ActiveState") == "failed" and world.locd.show("ExecMainStatus") == "65"
    # Whoever stops it ends the tries as well.
    assert world.guest.check("systemctl is-active locd-again.timer") == "active"
    world.locd.stop()
    assert world.guest.run("systemctl is-active locd-again.timer")[1] == "inactive"
    world.guest.run("systemctl start locd", timeout_s=120)
    world.guest.check("cp /share/etc/room.map /etc/locd/room.map")
    session = world.wait_for_full_pose()["session"]
    world.guest.check(f"kill -TERM {world.locd.pid()}")
    world.hearing.mark()
    world.hearing.wait_for("pose of another session", "POSE",
                           lambda m: m["session"] != session and m["cameras_used"] == 3, timeout_s=90)


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
