#!/usr/bin/env python3
"""Makes the true map of a simulated capture: groundtruth/markers.tum with the sizes of markers.toml.

Usage: true_map.py MAPBUILDER CAPTURE MAP
Covariances are zero: the map is exact.
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import tomllib


def ids_of(text):
    if isinstance(text, list):
        return [int(i) for i in text]
    ids = []
    for part in text.split(","):
        first, _, last = part.strip().partition("-")
        ids.extend(range(int(first), int(last or first) + 1))
    return ids


def sizes_of(path):
    """{family: (default size, {number: size})} of a markers.toml."""
    blocks = tomllib.loads(path.read_text())["markers"]
    if isinstance(blocks, dict):
        blocks = [blocks]
    sizes = {}
    for block in blocks:
        listed = {i: e["size_m"] for e in block.get("sizes", []) for i in ids_of(e["ids"])}
        sizes[block["family"]] = (block.get("size_m"), listed)
    return sizes


def true_map(capture):
    capture = pathlib.Path(capture)
    sizes = sizes_of(capture / "markers.toml")
    markers = []
    for line in (capture / "groundtruth/markers.tum").read_text().splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        key, *numbers = line.split()
        family, _, number = key.rpartition(":")
        family = family or next(iter(sizes))
        default, listed = sizes[family]
        values = [float(n) for n in numbers]
        markers.append({
            "id": key if len(sizes) > 1 else int(number),
            "family": family,
            "size_m": listed.get(int(number), default),
            "position_m": values[:3],
            "quaternion_xyzw": values[3:],
        })
    return {"schema": 1, "submaps": [{"markers": markers}]}


def write_true_map(mapbuilder, capture, out):
    with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
        json.dump(true_map(capture), file)
        file.flush()
        subprocess.run([mapbuilder, "import", file.name, "-o", out], check=True,
                       stdout=subprocess.DEVNULL)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    write_true_map(*sys.argv[1:])
