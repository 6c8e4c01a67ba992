"""locd in the guest, as systemd runs it."""

import contextlib
import pathlib
import shutil

CONFIG = """[map]
path = "{map}"
[rig]
camchain = "rig.yaml"
{cameras}
[sync]
tolerance_us = 200000
deadline_ms = 900
[solve]
time_budget_ms = 20000
v_max_mps = 100
w_max_dps = 10000
[lcm]
url = "{url}"
[record]
dir = "/var/lib/locd/recordings"
min_free_bytes = {min_free_bytes:.0f}
max_bytes = {max_bytes:.0f}
markers = "markers.toml"
[service]
startup_wait_s = {startup_wait_s}
realtime = {realtime}
lock_memory = {lock_memory}
"""
CAMERA = """[[camera]]
name = "cam{number}"
driver = "{driver}"
device = "{device}"
{fps}exposure_us = 3000
gain = {gain}
"""
URL = "udpm://239.255.76.67:7667?ttl=0"


class Locd:
    def __init__(self, guest, share, inputs):
        self.guest = guest
        self.share = pathlib.Path(share)
        self.inputs = pathlib.Path(inputs)

    def configure(self, driver="v4l2", devices=("serial=WM-0", "serial=WM-1", "serial=WM-2"), map_file="room.map",
                  startup_wait_s=60, gain=40, fps="fps = 1\n", realtime=False, lock_memory=False,
                  min_free_bytes=0, max_bytes=1e9, url=URL):
        """Writes /etc/locd; takes effect with the next restart or reload. devices: in the rig's order."""
        etc = self.share / "etc"
        etc.mkdir(exist_ok=True)
        for source in ("room.map", "other.map", "capture/rig.yaml", "capture/markers.toml"):
            shutil.copy(self.inputs / source, etc)
        cameras = "".join(CAMERA.format(number=i, driver=driver, device=device, gain=gain, fps=fps)
                          for i, device in enumerate(devices))
        (etc / "locd.toml").write_text(
            CONFIG.format(map=map_file, cameras=cameras, url=url, startup_wait_s=startup_wait_s,
                          realtime=str(realtime).lower(), lock_memory=str(lock_memory).lower(),
                          min_free_bytes=min_free_bytes, max_bytes=max_bytes),
            encoding="utf-8")
        self.guest.check("cp /share/etc/* /etc/locd/ && chmod 644 /etc/locd/*")

    @contextlib.contextmanager
    def realtime_drop_in(self):
        """The package's own, as operations.md says."""
        drop_in = "/etc/systemd/system/locd.service.d/realtime.conf"
        self.guest.check(f"install -D /usr/share/waymark-locd/realtime.conf {drop_in} && systemctl daemon-reload")
        try:
            yield
        finally:
            self.guest.check(f"rm {drop_in} && systemctl daemon-reload")

    def start(self):
        """Starts it anew, whatever was."""
        self.guest.check("systemctl reset-failed locd; systemctl restart locd", timeout_s=120)

    def stop(self):
        self.guest.check("systemctl stop locd", timeout_s=60)

    def quiet(self):
        """Stopped, also where it is not even installed."""
        self.guest.run("systemctl stop locd", timeout_s=60)

    def note_time(self):
        """From here on lines_since counts."""
        self.guest.check("journalctl -q -n 0 --show-cursor | sed -n 's/^-- cursor: //p' >/run/waymark-cursor")

    def lines_since(self):
        """Of its log, since note_time."""
        return self.guest.check("journalctl -q -u locd -o cat --after-cursor=\"$(cat /run/waymark-cursor)\"").splitlines()

    def show(self, field):
        """A property of the unit, as systemctl show prints it."""
        return self.guest.check(f"systemctl show --value --property={field} locd")

    def pid(self):
        return int(self.show("MainPID"))

    def has_said(self, text):
        """Whether the log of the process that runs now holds a text."""
        return self.guest.run("journalctl -q -u locd -o cat _PID=$(systemctl show --value -p MainPID locd) | "
                              f"grep -qF '{text}'")[0] == 0

    def journal(self):
        """The end of the service's log, for a message."""
        return self.guest.run("journalctl --quiet --no-pager -o cat -n 25 -u locd")[1]

    def request(self, line):
        """Answer to a line on the control socket, as somebody of group locd."""
        return self.guest.check(f"echo {line} | setpriv --reuid nobody --regid locd --clear-groups "
                                "nc -U -N -w 60 /run/locd/control")
