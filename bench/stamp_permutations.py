#!/usr/bin/env python3
"""Builds the same capture ten times with permuted stamps; the map must not notice.

Usage: stamp_permutations.py MAPBUILDER CAPTURE [BUILD OPTION ...]

Prints the largest difference of any marker's position and of any frame set's position (m).
"""

import math
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile


def read_tum(path):
    rows = (line.split() for line in path.read_text().splitlines() if not line.startswith("#"))
    return {row[0]: [float(v) for v in row[1:4]] for row in rows}


def build(mapbuilder, capture, rows, header, options):
    """Marker positions by id and rig positions by stamp (s, text)."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for file in ("rig.yaml", "markers.toml"):
            shutil.copy(capture / file, folder)
        (folder / "detections.csv").write_text("\n".join([header, *rows]) + "\n")
        quiet = {"check": True, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        subprocess.run(
            [mapbuilder, "build", folder, "-o", folder / "map", "--trajectory", folder / "t.tum", *options],
            **quiet,
        )
        subprocess.run(
            [mapbuilder, "export", folder / "map", "--format", "tum", "-o", folder / "m.tum"], **quiet
        )
        return read_tum(folder / "m.tum"), read_tum(folder / "t.tum")


def seconds(stamp_ns):
    return f"{int(stamp_ns) // 10**9}.{int(stamp_ns) % 10**9:09d}"


def main():
    mapbuilder, capture, options = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3:]
    lines = [l for l in (capture / "detections.csv").read_text().splitlines() if not l.startswith("#")]
    header, rows = lines[0], [line.split(",", 1) for line in lines[1:]]
    stamps = sorted({stamp for stamp, _ in rows})
    markers, poses = build(mapbuilder, capture, [",".join(row) for row in rows], header, options)
    worst_marker = worst_pose = 0.0
    for seed in range(10):
        shuffled = stamps[:]
        random.Random(seed).shuffle(shuffled)
        new = dict(zip(stamps, shuffled))
        permuted = [f"{new[stamp]},{rest}" for stamp, rest in rows]
        m, p = build(mapbuilder, capture, permuted, header, options)
        assert m.keys() == markers.keys() and len(p) == len(poses), "other markers or poses"
        worst_marker = max([worst_marker, *(math.dist(m[i], markers[i]) for i in m)])
        worst_pose = max(
            [worst_pose, *(math.dist(p[seconds(new[s])], poses[seconds(s)]) for s in stamps if seconds(s) in poses)]
        )
    print(f"10 permutations: markers within {worst_marker:.2e} m, poses within {worst_pose:.2e} m")


if __name__ == "__main__":
    main()
