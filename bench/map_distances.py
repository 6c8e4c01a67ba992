#!/usr/bin/env python3
"""Distances in a finished map against what was measured: a survey's distances and boards of known pitch.

Usage: map_distances.py MAPBUILDER MAP CAPTURE [--boards]

Prints the RMS over survey.toml's [[distances]]; with --boards (the aviary) also over the 15 centre
distances of every 2×3 board: start ids 6…72 and 84…102 by 6, row-major, pitch 0.150 m.
"""

import csv
import itertools
import math
import pathlib
import subprocess
import sys
import tempfile
import tomllib

CORNERS = {
    "center": (0, 0),
    "top-left": (-0.5, 0.5),
    "top-right": (0.5, 0.5),
    "bottom-right": (0.5, -0.5),
    "bottom-left": (-0.5, -0.5),
}


def rotate(q, v):
    """Hamilton quaternion x y z w applied to a vector."""
    x, y, z, w = q
    t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])]
    return [
        v[0] + w * t[0] + y * t[2] - z * t[1],
        v[1] + w * t[1] + z * t[0] - x * t[2],
        v[2] + w * t[2] + x * t[1] - y * t[0],
    ]


def read_map(mapbuilder, path):
    """world_from_marker and size per id of the first sub-map."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "map.csv"
        subprocess.run([mapbuilder, "export", path, "--format", "csv", "-o", out], check=True)
        rows = list(csv.DictReader(out.open()))
    return {
        int(r["id"]): (
            [float(r[k]) for k in ("x_m", "y_m", "z_m")],
            [float(r[k]) for k in ("qx", "qy", "qz", "qw")],
            float(r["size_m"]),
        )
        for r in rows
    }


def point(markers, where):
    position, q, size = markers[where["id"]]
    x, y = CORNERS[where.get("corner", "center")]
    return [a + b for a, b in zip(position, rotate(q, [x * size, y * size, 0]))]


def rms(values):
    return math.sqrt(sum(v * v for v in values) / len(values))


def main():
    mapbuilder, map_path, capture = sys.argv[1:4]
    markers = read_map(mapbuilder, map_path)
    survey = tomllib.loads((pathlib.Path(capture) / "survey.toml").read_text())
    errors = [
        math.dist(point(markers, d["from"]), point(markers, d["to"])) - d["distance_m"]
        for d in survey["distances"]
        if d["from"]["id"] in markers and d["to"]["id"] in markers
    ]
    print(f"{len(errors)} of {len(survey['distances'])} survey distances: RMS {1e3 * rms(errors):.2f} mm")
    if "--boards" not in sys.argv:
        return
    errors = []
    for start in [*range(6, 73, 6), *range(84, 103, 6)]:
        for a, b in itertools.combinations(range(6), 2):
            truth = 0.150 * math.dist(divmod(a, 3), divmod(b, 3))
            errors.append(math.dist(markers[start + a][0], markers[start + b][0]) - truth)
    print(f"{len(errors)} board distances: RMS {1e3 * rms(errors):.3f} mm")


if __name__ == "__main__":
    main()
