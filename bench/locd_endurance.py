#!/usr/bin/env python3
"""Lets locd run and watches what it holds: memory, descriptors, threads, log lines.

Usage: locd_endurance.py LOCD MAPBUILDER SIMULATOR [MINUTES]

Three rendered cameras, played at 10 sets a second; messages stay inside the process (memq://). The first
tenth of the time is warm-up. The slope of the resident memory is a least-squares line through the rest.
"""

import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

CONFIG = """[map]
path = "room.map"
[rig]
camchain = "room/rig.yaml"
{cameras}
[sync]
deadline_ms = 60
[solve]
time_budget_ms = 1000
[lcm]
url = "memq://"
"""
CAMERA = '[[camera]]\nname = "cam{}"\ndriver = "replay"\ndevice = "room"\n'


def prepare(mapbuilder, simulator, folder):
    """A room of 40 sets, 0.1 s apart, and its map."""
    room = folder / "room"
    quiet = {"check": True, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    subprocess.run([simulator, "render", "--scene", "room1", "--rig", "cg120", "--positions", "40",
                    "-o", room], **quiet)
    subprocess.run([mapbuilder, "build", room, "-o", folder / "room.map"], **quiet)
    for camera in ("cam0", "cam1", "cam2"):
        for i, image in enumerate(sorted((room / camera).iterdir())):
            image.rename(image.with_name(f"{(i + 1) * 100_000_000}{image.suffix}"))
    for stale in ("frames.csv", "detections.csv"):
        (room / stale).unlink(missing_ok=True)
    (folder / "locd.toml").write_text(
        CONFIG.format(cameras="".join(CAMERA.format(c) for c in range(3))), encoding="utf-8")


def sample(pid):
    """Resident kB, descriptors, threads, seconds of processor time."""
    status = pathlib.Path(f"/proc/{pid}/status").read_text(encoding="ascii")
    fields = dict(line.split(":", 1) for line in status.splitlines())
    ticks = pathlib.Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
    seconds = (int(ticks[11]) + int(ticks[12])) / os.sysconf("SC_CLK_TCK")
    return (int(fields["VmRSS"].split()[0]), len(os.listdir(f"/proc/{pid}/fd")), int(fields["Threads"]), seconds)


def slope(times, values):
    """Of the least-squares line."""
    mean_t = sum(times) / len(times)
    mean_v = sum(values) / len(values)
    return (sum((t - mean_t) * (v - mean_v) for t, v in zip(times, values))
            / sum((t - mean_t) ** 2 for t in times))


def main():
    locd, mapbuilder, simulator = (pathlib.Path(p).resolve() for p in sys.argv[1:4])
    minutes = float(sys.argv[4]) if len(sys.argv) > 4 else 10.0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        prepare(mapbuilder, simulator, folder)
        environment = dict(os.environ, RUNTIME_DIRECTORY=name, STATE_DIRECTORY=name)
        with open(folder / "log", "wb") as log:
            process = subprocess.Popen([locd, "--config", folder / "locd.toml"], env=environment, stderr=log)
        samples = []
        begun = time.monotonic()
        while time.monotonic() - begun < 60 * minutes:
            try:
                code = process.wait(timeout=1)
            except subprocess.TimeoutExpired:
                samples.append((time.monotonic() - begun, *sample(process.pid)))
                continue
            print((folder / "log").read_text(encoding="utf-8"))
            sys.exit(f"locd ended by itself with {code}")
        process.send_signal(signal.SIGTERM)
        process.wait(timeout=10)
        lines = (folder / "log").read_text(encoding="utf-8").splitlines()
        warm = [s for s in samples if s[0] > 6 * minutes]
        memory = slope([s[0] for s in warm], [s[1] / 1024 for s in warm]) * 3600
        print(f"{minutes:g} minutes: resident {warm[0][1] / 1024:.1f} to {warm[-1][1] / 1024:.1f} MB, "
              f"{memory:+.2f} MB/h; descriptors {min(s[2] for s in warm)}–{max(s[2] for s in warm)}, "
              f"threads {min(s[3] for s in warm)}–{max(s[3] for s in warm)}; "
              f"{100 * warm[-1][4] / warm[-1][0]:.0f} % of a core; {len(lines)} log lines")
        print("\n".join(lines))


if __name__ == "__main__":
    main()
