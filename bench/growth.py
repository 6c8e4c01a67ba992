#!/usr/bin/env python3
"""Build time and peak memory of mapbuilder over the size of the building: detections in, map out.

Usage: growth.py SIMULATOR MAPBUILDER WORK_FOLDER [AISLES...]     (default: 6 26 100: 1,200 to 20,000 markers)

Simulates warehouses of that many aisles into WORK_FOLDER (kept, so that a second run is quick), builds
each map, and fits time ~ markers^exponent to processor time (user + system), which other load on the
machine does not stretch as it does wall time.
"""

import math
import os
import pathlib
import re
import sys
import time


def run(arguments):
    """Runs a command; returns its output, wall time (s), processor time (s), peak memory (MB)."""
    read, write = os.pipe()
    started = time.monotonic()
    pid = os.fork()
    if pid == 0:
        os.dup2(write, 1)
        os.close(read)
        os.execv(arguments[0], arguments)
    os.close(write)
    with os.fdopen(read) as stream:
        output = stream.read()
    _, status, usage = os.wait4(pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(map(str, arguments))} failed")
    return output, time.monotonic() - started, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def main():
    simulator, mapbuilder, work = sys.argv[1:4]
    rows = []
    for aisles in [int(a) for a in sys.argv[4:]] or [6, 26, 100]:
        capture = pathlib.Path(work) / f"aisles{aisles}"
        if not capture.exists():
            run([simulator, "detections", "--scene", f"aisles{aisles}", "--rig", "cg120", "--noise-px", "0.1",
                 "-o", str(capture)])
        output, wall, cpu, memory = run([mapbuilder, "build", str(capture), "-o", f"{work}/aisles{aisles}.map"])
        first = re.search(r"sub-map 0: (\d+) markers, (\d+) frame sets", output)
        markers, sets = int(first[1]), int(first[2])
        parts = len(re.findall(r"^sub-map \d+: \d+ markers", output, re.M))
        rows.append((markers, cpu))
        print(f"{markers} markers, {sets} frame sets, {parts} sub-map(s): {wall:.1f} s wall, {cpu:.1f} s CPU, "
              f"{memory:.0f} MB", flush=True)
    if len(rows) > 1:
        x = [math.log(m) for m, _ in rows]
        y = [math.log(c) for _, c in rows]
        mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
        slope = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x)
        print(f"time grows as markers^{slope:.2f}")


if __name__ == "__main__":
    main()
