#!/usr/bin/env python3
"""Content hashes of maps: what must not change when the code is made anew and nothing is measured otherwise.

Usage: content_hashes.py MAPBUILDER SIMULATOR SHARED [NAME...]

Builds the data sets below SHARED/datasets and simulated captures, plain and with survey or refinement, and prints
for each the map's hash, processor time and peak memory, and for `localize` a hash of the trajectory. Captures are
copied, so that nothing is written into SHARED. With NAMEs, those alone.
"""

import hashlib
import pathlib
import re
import shutil
import sys
import tempfile

import growth

REFINED = ["--refine", "extrinsics,intrinsics"]
ERRORS = ["--twins", "3", "--moved", "3", "--mis-sized", "2", "--false-rate", "0.01"]
DATA_SETS = ["aviary", "tag_table", "pennstock", "office_wall"]
SIMULATED = {
    "room1": ["--scene", "room1", "--rig", "cg120", "--noise-px", "0.1"],
    "room1_errors": ["--scene", "room1", "--rig", "cg60", "--noise-px", "0.1", *ERRORS],
    "warehouse": ["--scene", "warehouse", "--rig", "cg120", "--noise-px", "0.1"],
    "warehouse_errors": ["--scene", "warehouse", "--rig", "cg120", "--noise-px", "0.1", *ERRORS],
}


def capture_of(name, simulator, shared, work):
    folder = work / name
    if name in SIMULATED:
        growth.run([simulator, "detections", *SIMULATED[name], "-o", str(folder)])
    else:
        shutil.copytree(pathlib.Path(shared) / "datasets" / name, folder)
        for path in [folder, *folder.rglob("*")]:
            path.chmod(0o755 if path.is_dir() else 0o644)
    return folder


def variants(folder):
    yield "plain", []
    if (folder / "survey.toml").exists():
        yield "survey", ["--survey", str(folder / "survey.toml")]
    yield "refine", REFINED


def main():
    mapbuilder, simulator, shared = sys.argv[1:4]
    wanted = sys.argv[4:] or [*DATA_SETS, *SIMULATED]
    with tempfile.TemporaryDirectory() as temporary:
        work = pathlib.Path(temporary)
        for name in wanted:
            folder = capture_of(name, simulator, shared, work)
            for variant, arguments in variants(folder):
                output, _, cpu, memory = growth.run(
                    [mapbuilder, "build", str(folder), "-o", str(work / f"{name}.map"), *arguments])
                found = re.search(r": map ([0-9a-f]{16}), built", output)[1]
                print(f"{name} {variant}: {found}  ({cpu:.1f} s CPU, {memory:.0f} MB)", flush=True)
            trajectory = work / f"{name}.tum"
            growth.run([mapbuilder, "localize", str(folder), "--map", str(work / f"{name}.map"),
                        "--trajectory", str(trajectory)])
            print(f"{name} localize: {hashlib.sha256(trajectory.read_bytes()).hexdigest()[:16]}", flush=True)


if __name__ == "__main__":
    main()
