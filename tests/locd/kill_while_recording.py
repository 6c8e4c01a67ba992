#!/usr/bin/env python3
"""Kills a recording locd at random moments; what is there must be a capture that mapbuilder reads.

Usage: kill_while_recording.py LOCD MAPBUILDER SIMULATOR [TIMES]

Every frame that frames.csv lists is there and whole, at most one set's images lie beside them, and at
most one image was being written. Every fourth recording goes on with the one before in a ring of ten
sets, a second: what it lists and lacks is older than all that is there, and less than half of the list.
(A ring by bytes: by age, what an earlier run has recorded goes only where a time service keeps the clock.)
"""

import math
import os
import pathlib
import random
import re
import signal
import subprocess
import sys
import tempfile
import time

CONFIG = """[rig]
camchain = "room/rig.yaml"
{cameras}
[sync]
deadline_ms = 40
[lcm]
url = "memq://"
[record]
codec = "{codec}"
max_bytes = {max_bytes}
min_free_bytes = 0
"""
CAMERA = '[[camera]]\nname = "cam{}"\ndriver = "replay"\ndevice = "room"\n'


def render(simulator, folder):
    """A capture of three small cameras, played at its own pace: 10 sets a second."""
    subprocess.run([simulator, "render", "--scene", "room1", "--rig", "cg120", "--positions", "4", "-o",
                    folder / "room"], check=True, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    for camera in ("cam0", "cam1", "cam2"):
        images = sorted((folder / "room" / camera).iterdir())
        for i, image in enumerate(images):
            image.rename(image.with_name(f"{(i + 1) * 50_000_000}{image.suffix}"))
    for stale in ("frames.csv", "detections.csv"):
        (folder / "room" / stale).unlink(missing_ok=True)


def kill_once(locd, folder, capture, moment_s):
    environment = dict(os.environ, RUNTIME_DIRECTORY=str(folder / "run"), STATE_DIRECTORY=str(folder))
    (folder / "run").mkdir(exist_ok=True)
    process = subprocess.Popen([locd, "--config", folder / "locd.toml", "--record", capture],
                               env=environment, stderr=subprocess.DEVNULL)
    cam0 = capture / "cam0"
    while process.poll() is None and not (cam0.is_dir() and any(f.suffix != ".part" for f in cam0.iterdir())):
        time.sleep(0.002)
    time.sleep(moment_s)
    process.send_signal(signal.SIGKILL)
    process.wait()


def judge(mapbuilder, capture, ring):
    """What is wrong with the capture; empty: nothing."""
    # What a kill left unfinished goes as the ring does; kills are about as far apart as it is long.
    unfinished = 2 if ring else 1
    rows = [line.split(",") for line in (capture / "frames.csv").read_text(encoding="utf-8").splitlines()[1:]]
    for camera in ("cam0", "cam1", "cam2"):
        recorded = {row[1] for row in rows if row[0] == camera}
        there = {f.stem for f in (capture / camera).iterdir() if not f.name.startswith(".")}
        deleted = {t for t in recorded - there if ring and int(t) < min(map(int, there), default=math.inf)}
        if recorded - there - deleted:
            return f"{camera} lacks {len(recorded - there)} frames that were recorded"
        if len(deleted) > len(recorded) / 2 + 1:
            return f"{camera} lists {len(deleted)} deleted frames among {len(recorded)}"
        if len(there - recorded) > unfinished:
            return f"{camera} has {len(there - recorded)} frames of sets that were not finished"
    halves = [f for f in capture.rglob(".*.part")]
    if len(halves) > 1:
        return f"{len(halves)} images were begun at a time"
    run = subprocess.run([mapbuilder, "detect", capture, "-o", capture / "detections.csv"],
                         capture_output=True, text=True, check=False)
    (capture / "detections.csv").unlink(missing_ok=True)
    if run.returncode != 0 or "skipped" in run.stderr:
        return f"mapbuilder: {run.returncode}: {run.stderr.strip()}"
    return ""


def bytes_of_ten_sets(rig):
    """Of three cameras' images, a byte per pixel."""
    width, height = re.search(r"resolution: \[(\d+), (\d+)\]", rig.read_text(encoding="utf-8")).groups()
    return max(1_000_000, 10 * 3 * int(width) * int(height))


def main():
    locd, mapbuilder, simulator = sys.argv[1:4]
    times = int(sys.argv[4]) if len(sys.argv) > 4 else 100
    moments = random.Random(7)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        render(simulator, folder)
        cameras = "".join(CAMERA.format(c) for c in range(3))
        ring_bytes = bytes_of_ten_sets(folder / "room/rig.yaml")
        bad = 0
        for i in range(times):
            ring = i % 4 == 2
            (folder / "locd.toml").write_text(
                CONFIG.format(cameras=cameras, codec="pgm" if i % 2 == 0 else "jpeg", max_bytes=ring_bytes if ring else 10_000_000_000),
                encoding="utf-8")
            capture = folder / ("ring" if ring else f"recording{i}")
            kill_once(locd, folder, capture, moments.uniform(0, 2.5 if ring else 0.4))
            wrong = judge(mapbuilder, capture, ring)
            if wrong:
                print(f"kill {i}: {wrong}")
                bad += 1
        print(f"{times} kills, {bad} captures with more lost than the frame being written")
        return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
