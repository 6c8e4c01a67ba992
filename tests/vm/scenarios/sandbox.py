"""What a program in locd's place could do: each hole is tried from inside a copy of the unit."""

import pathlib
import shutil

HERE = pathlib.Path(__file__).resolve().parent

NEEDED = {"own-state", "own-runtime", "camera", "own-group", "program-of-the-system", "notify"}
# What a copy of the unit runs in place of locd, once.
INSIDE = """
[Unit]
OnFailure=
[Service]
Type=oneshot
NotifyAccess=none
WatchdogSec=0
TimeoutStartSec=600
Restart=no
StandardOutput=truncate:/run/waymark-inside
StandardError=inherit
ExecReload=
ExecStart=
"""


def run_inside(world, command, timeout_s=300):
    """Runs a command as locd.service would run locd; (how systemd says it ended, its output)."""
    unit = "/run/systemd/system/locd-inside.service"
    (world.share / "inside.conf").write_text(f"{INSIDE}ExecStart={command}\n", encoding="utf-8")
    world.guest.check(f"sed 's/RuntimeDirectory=locd/RuntimeDirectory=locd-inside locd/' "
                      f"/lib/systemd/system/locd.service >{unit} && cat /share/inside.conf >>{unit} && "
                      "systemctl daemon-reload && systemctl reset-failed locd-inside 2>/dev/null; true")
    world.guest.run("systemctl start locd-inside", timeout_s)
    result = world.guest.check("systemctl show --value --property=Result locd-inside")
    output = world.guest.check("cat /run/waymark-inside")
    world.guest.check(f"rm {unit} && systemctl daemon-reload")
    return result, output


def holes(world):
    """Whoever gains control of locd's process can do what locd does and nothing else of what is tried here."""
    world.prepare()
    world.locd.stop()
    shutil.copy(HERE.parent / "guest/holes.sh", world.share)
    # What a hole would lead to has to be there.
    world.guest.check("install -m 755 /share/holes.sh /usr/local/bin/waymark-holes; "
                      "perl -e 'defined shmget(0x57415921, 4096, 01666) or die $!'; mkdir -p /run/dbus; "
                      "test -S /run/dbus/system_bus_socket || systemd-run --quiet --unit=bus nc -lkU /run/dbus/system_bus_socket; "
                      "mkdir -p /dev/mqueue")
    result, output = run_inside(world, "/usr/bin/bash /usr/local/bin/waymark-holes")
    assert result == "success", f"{result}: {output}"
    found = dict(line.rsplit(" ", 1) for line in output.splitlines() if line.endswith((" open", " shut")))
    assert len(found) > 35, output
    is_open = {name for name, state in found.items() if state == "open"}
    assert is_open == NEEDED, f"open, but not to be: {is_open - NEEDED}; shut, but needed: {NEEDED - is_open}"
    # The same, unconfined: each of these would be found.
    unconfined = world.guest.run("bash /usr/local/bin/waymark-holes", 120)[1]
    for name in ("write:/dev/shm", "execute:/var/lib/locd", "send:127.0.0.1", "send:239.1.2.3", "shared-memory", "bus",
                 "namespace", "setuid", "processes", "clock", "name", "kernel", "packets", "inet6", "many"):
        assert f"{name} open" in unconfined, f"{name} can't be found open anywhere: {unconfined}"


def memory_limit(world):
    """Who takes more than half of the memory is ended whole; no other program is."""
    world.prepare()
    world.locd.stop()
    limit = int(world.guest.check("systemctl show --value --property=MemoryMax locd"))
    total = 1024 * int(world.guest.check("sed -n 's/^MemTotal: *\\([0-9]*\\) kB/\\1/p' /proc/meminfo"))
    assert 0.45 * total < limit < 0.55 * total, f"{limit} of {total} bytes"
    # In strides, so that emulation need not touch every page more than once.
    result, output = run_inside(world, f"/usr/bin/perl -e 'my @held; push @held, \"x\" x (10_000_000 + $$_) for 1..{total // 10_000_000}'")
    assert result == "oom-kill", f"{result}: {output}"
    assert world.guest.check("systemctl is-active listener") == "active"
