#!/usr/bin/env python3
"""Hold-out: builds a map from a capture's even frame sets, localizes the odd ones against it.

Usage: hold_out.py MAPBUILDER CAPTURE

Needs a capture with detections.csv. Stamps within 5 ms are one frame set. Prints both RMS over all
corners and their ratio.
"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SYNC_TOLERANCE_NS = 5_000_000


def split(lines):
    """Rows of even and of odd frame sets, each with the header."""
    header = next(i for i, line in enumerate(lines) if not line.startswith("#"))
    rows = sorted(lines[header + 1 :], key=lambda row: int(row.split(",")[0]))
    halves = ([lines[header]], [lines[header]])
    frame_set, first = -1, None
    for row in rows:
        stamp = int(row.split(",")[0])
        if first is None or stamp - first > SYNC_TOLERANCE_NS:
            frame_set, first = frame_set + 1, stamp
        halves[frame_set % 2].append(row)
    return halves


def rms_all_px(output):
    return float(re.search(r"([0-9.]+) px over all", output).group(1))


def main():
    mapbuilder, capture = sys.argv[1], pathlib.Path(sys.argv[2])
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        halves = split((capture / "detections.csv").read_text().splitlines())
        for name, rows in zip(("even", "odd"), halves):
            (folder / name).mkdir()
            for file in ("rig.yaml", "markers.toml"):
                shutil.copy(capture / file, folder / name)
            (folder / name / "detections.csv").write_text("\n".join(rows) + "\n")
        run = lambda *words: subprocess.run(
            [mapbuilder, *words], check=True, text=True, stdout=subprocess.PIPE
        ).stdout
        built = rms_all_px(run("build", folder / "even", "-o", folder / "map"))
        localized = rms_all_px(
            run("localize", folder / "odd", "--map", folder / "map", "--trajectory", folder / "t.tum")
        )
        print(f"build {built:.4f} px, localize {localized:.4f} px, ratio {localized / built:.4f}")


if __name__ == "__main__":
    main()
