#!/usr/bin/env python3
"""Maps a rendered building on one way, localizes another way through it, aligned on the map's markers.

Usage: locd_rendered.py BUILD SCENES OUT [SCENE…]
BUILD is the build folder, SCENES the folder of scene files, OUT keeps the captures: what is there
already is used again. The other way is the scene's own driven backwards, 0.1 m higher, looking 20°
further to the left, at POSITIONS positions.
"""

import json
import os
import pathlib
import re
import subprocess
import sys

POSITIONS = int(os.environ.get("POSITIONS", "24"))


def run(*command):
    result = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if result.returncode != 0:
        sys.exit(f"{' '.join(str(c) for c in command)}\n{result.stderr[-2000:]}")
    return result.stdout


def other_way(scene):
    """The scene's text with its way driven backwards, higher, looking elsewhere."""
    head, way = scene.split("[trajectory]")
    points = re.findall(r"\{ at_m = \[([^,]+), ([^,]+), ([^\]]+)\](?:, look_deg = ([-\d.]+))?.*?\}", way)
    assert len(points) >= 3, "no way-points found"
    lines = [f"  {{ at_m = [{x}, {y}, {float(z) + 0.1:.3f}], look_deg = {float(look or 0) + 20} }},"
             for x, y, z, look in reversed(points)]
    keys = way.split("waypoints")[0]
    return f"{head}[trajectory]{keys}waypoints = [\n" + "\n".join(lines) + "\n]\n"


def measure(build, scenes, out, name):
    simulator = build / "simulator/simulator"
    mapbuilder = build / "mapbuilder/mapbuilder"
    mapped, driven = out / f"{name}-mapped", out / f"{name}-driven"
    if not mapped.exists():
        run(simulator, "render", "--scene", name, "--rig", "cg120", "-o", mapped)
    if not driven.exists():
        variant = out / f"{name}.toml"
        variant.write_text(other_way((scenes / f"{name}.toml").read_text()))
        run(simulator, "render", "--scene", variant, "--rig", "cg120", "--positions", POSITIONS,
            "--seed", 2, "-o", driven)
    map_file = out / f"{name}.map"
    run(mapbuilder, "build", mapped, "-o", map_file)
    tum, table = out / f"{name}.tum", out / f"{name}.csv"
    summary = run(build / "locd/locd", "--replay", driven, "--map", map_file, "--trajectory", tum,
                  "--table", table, "--redetect").strip()
    result = json.loads(run(mapbuilder, "evaluate", "--map", map_file, "--trajectory", tum,
                            "--truth", driven / "groundtruth", "--json"))
    cameras = result["submaps"][0]["cameras_in_map"]
    print(f"{name}: {summary}; {1e3 * cameras['translation_rmse_m']:.2f} mm "
          f"{cameras['rotation_rmse_deg']:.4f}° RMSE", flush=True)


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    build, scenes, out = (pathlib.Path(a) for a in sys.argv[1:4])
    out.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[4:] or ["room1", "warehouse", "pool"]:
        measure(build, scenes, out, name)


if __name__ == "__main__":
    main()
