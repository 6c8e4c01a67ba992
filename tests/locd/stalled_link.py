#!/usr/bin/env python3
"""locd on an interface that takes no packets: messages are lost, counted and said; the watchdog is fed, requests are
answered, and SIGTERM ends it. When the interface takes packets again, that is said, with how many were lost.

To be run in a network namespace of its own. Usage: stalled_link.py LOCD
"""

import pathlib
import re
import socket
import subprocess
import sys
import tempfile
import time

import hundred_sets

PATIENCE_S = 60
URL = "udpm://239.255.76.67:7667?ttl=1"
# More than a few of the watchdog's meals, with nothing going out.
FEEDS = 8


class Systemd:
    """What it would hear of locd."""

    def __init__(self, folder):
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(str(folder / "notify"))
        self.socket.settimeout(PATIENCE_S)

    def wait_for(self, pattern):
        deadline = time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline:
            heard = self.socket.recv(8192).decode()
            if re.search(pattern, heard):
                return heard
        raise AssertionError(f"never heard: {pattern}")


def ask(folder, request):
    with socket.socket(socket.AF_UNIX) as control:
        control.settimeout(PATIENCE_S)
        control.connect(str(folder / "control"))
        control.sendall(request.encode() + b"\n")
        return control.recv(4096).decode()


def wait_for_line(log, text):
    deadline = time.monotonic() + PATIENCE_S
    while text not in log.read_text(encoding="utf-8"):
        assert time.monotonic() < deadline, f"never said: {text}\n{log.read_text(encoding='utf-8')}"
        time.sleep(0.05)
    return next(line for line in log.read_text(encoding="utf-8").splitlines() if text in line)


def tc(*arguments):
    subprocess.run(["tc", "qdisc", *arguments], check=True)


def main():
    with tempfile.TemporaryDirectory() as work:
        folder = pathlib.Path(work)
        hundred_sets.write_inputs(folder, URL)
        systemd = Systemd(folder)
        log = folder / "log"
        with open(log, "wb") as log_file, \
                hundred_sets.start(sys.argv[1], folder, log_file, WATCHDOG_USEC="2000000",
                                   NOTIFY_SOCKET=str(folder / "notify")) as locd:
            try:
                systemd.wait_for("READY=1")
                tc("add", "dev", "lo", "root", "tbf", "rate", "1kbit", "burst", "2000", "limit", "10mb")
                assert "the network takes no packets" in wait_for_line(log, "LINK: messages are not taken")
                systemd.wait_for("STATUS=.*LCM takes no messages")
                for _ in range(FEEDS):
                    systemd.wait_for("WATCHDOG=1")
                assert ask(folder, "status").startswith("ok"), "it answers no requests"
                tc("del", "dev", "lo", "root")
                lost = re.search(r"(\d+) were not", wait_for_line(log, "LINK is over"))
                assert lost and int(lost[1]) > 100, lost
                tc("add", "dev", "lo", "root", "tbf", "rate", "1kbit", "burst", "2000", "limit", "10mb")
                systemd.wait_for("STATUS=.*LCM takes no messages")
                locd.terminate()
                assert locd.wait(PATIENCE_S) == 0, "SIGTERM did not end it well"
            finally:
                locd.kill()
    return 0


if __name__ == "__main__":
    sys.exit(main())
