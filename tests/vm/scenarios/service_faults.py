"""What happens to the service: reloads, kills, threads that are stuck, second instances, a disk it may not touch."""

import shutil


def good_reload(world):
    """Another map takes the old one's place without a restart."""
    world.localize()
    before = world.wait_for_full_pose()
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
    """A map that is damaged, too new, absent, or a key that needs a restart: refused whole, said everywhere."""
    world.localize()
    before = world.wait_for_full_pose()
    for damage, word in (("head -c 3000 /share/etc/room.map >/etc/locd/room.map", "room.map"),
                         # The format's version is the ninth byte.
                         ("printf '\\143' | dd of=/etc/locd/room.map bs=1 seek=8 conv=notrunc 2>&1", "version 99"),
                         ("rm /etc/locd/room.map", "room.map"),
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
    world.localize()
    session = world.wait_for_full_pose()["session"]
    folder = world.locd.request("start").removeprefix("ok ")
    world.hearing.mark()
    world.hearing.wait_for("recording", "STATUS", lambda m: m["recorded_sets"] >= 3)
    restarts = int(world.locd.show("NRestarts"))
    world.guest.check("systemctl kill -s KILL locd")
    world.hearing.mark()
    world.hearing.wait_for("pose of another session", "POSE",
                           lambda m: m["session"] != session and m["cameras_used"] == 3, timeout_s=90)
    assert int(world.locd.show("NRestarts")) == restarts + 1
    shutil.rmtree(world.share / "killed", ignore_errors=True)
    world.guest.check(f"cp -r {folder} /share/killed")
    code, text = world.native("compare_recording", world.share / "killed", world.capture)
    assert code == 0, text
    code, text = world.native("mapbuilder", "detect", world.share / "killed", "-o", world.run / "killed.csv")
    assert code == 0 and "skipped" not in text, text


def stuck_thread(world):
    """The solving thread hangs: the watchdog ends the service, systemd starts it again."""
    world.localize()
    session = world.wait_for_full_pose()["session"]
    pid = world.locd.pid()
    thread = world.guest.check(f"for t in /proc/{pid}/task/*; do echo $(basename $t) $(cat $t/comm); done | "
                               "awk '$2 == \"localization\" { print $1; exit }'")
    assert thread.isdigit(), world.guest.run(f"cat /proc/{pid}/task/*/comm")[1]
    world.hearing.mark()
    world.guest.check(f"systemd-run --quiet --unit=holder /share/bin/vm_hold_thread {thread}")
    world.hearing.wait_for("pose of another session", "POSE",
                           lambda m: m["session"] != session and m["cameras_used"] == 3, timeout_s=90)
    world.guest.check("journalctl -q -u locd | grep -qi 'watchdog timeout'")


def clock_steps(world):
    """The wall clock is set by an hour: utime does not jump; a TIME alert and a counter say it."""
    world.localize()
    world.hearing.mark()
    steps = world.hearing.wait_for("status", "STATUS", lambda m: True)["time_steps"]
    before = world.wait_for_full_pose()
    world.guest.check("date --set=@$(($(date +%s) + 3600))")
    try:
        world.hearing.wait_for("TIME", "ALERT", lambda m: m["raised"] and m["kind"] == "TIME")
        world.hearing.wait_for("counted step", "STATUS", lambda m: m["time_steps"] > steps)
        after = world.wait_for_full_pose()
        by_utime_s = (after["utime"] - before["utime"]) / 1e6
        by_clock_s = after["heard_s"] - before["heard_s"]
        assert abs(by_utime_s - by_clock_s) < 30, f"utime went on by {by_utime_s} s in {by_clock_s} s"
        assert after["session"] == before["session"], "it was restarted"
    finally:
        world.guest.check("date --set=@$(($(date +%s) - 3600))")
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
    """Within the unit's own view of the system nothing but its folders can be written, not even by root."""
    world.localize()
    pid = world.locd.pid()
    inside = f"nsenter --target {pid} --mount --"
    written = world.guest.check(
        f"for folder in / /etc /usr /usr/bin /var /var/log /var/lib /root /home /boot /srv /opt /proc/sys/kernel; do "
        f"{inside} touch $folder/waymark-was-here 2>/dev/null && echo $folder; done; true")
    assert written == "", f"can be written: {written}"
    as_locd = f"{inside} setpriv --reuid locd --regid locd --init-groups"
    assert world.guest.run(f"{as_locd} touch /etc/locd/waymark-was-here")[0] != 0, "it can write its configuration"
    for folder in ("/var/lib/locd", "/run/locd"):
        world.guest.check(f"{as_locd} touch {folder}/waymark-was-here && rm {folder}/waymark-was-here")
    owned = world.guest.check("find /dev /etc /home /opt /root /run /srv /tmp /var -user locd "
                              "-not -path '/var/lib/locd*' -not -path '/run/locd*'")
    assert owned == "", f"files elsewhere: {owned}"
