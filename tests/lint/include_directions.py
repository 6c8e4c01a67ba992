#!/usr/bin/env python3
"""Holds the include directions of the tree against one table: no circles, no arrow from core up.

Usage: include_directions.py ROOT [--selftest]
"""

import pathlib
import re
import sys

# A folder may include itself and what stands here, each with all it may include in turn.
MAY_INCLUDE = {
    "core/base": [],
    "core/geometry": ["core/base"],
    "core/camera": ["core/geometry"],
    "core/marker": ["core/geometry"],
    "core/capture": ["core/camera", "core/marker"],
    "core/detect": ["core/capture"],
    "core/map": ["core/marker", "proto"],
    "core/estimate": ["core/capture", "core/map"],
    "mapbuilder": ["mapbuilder/commands", "manual"],
    "mapbuilder/import": ["core/capture", "proto"],
    "mapbuilder/referees": ["core/detect"],
    "mapbuilder/observations": ["core/detect", "core/estimate", "mapbuilder/import", "mapbuilder/referees"],
    "mapbuilder/bundle": ["mapbuilder/observations"],
    "mapbuilder/growth": ["mapbuilder/bundle"],
    "mapbuilder/calibration": ["mapbuilder/growth"],
    "mapbuilder/build": ["mapbuilder/calibration"],
    "mapbuilder/diagnosis": ["mapbuilder/build"],
    "mapbuilder/evaluate": ["mapbuilder/build"],
    "mapbuilder/report": ["mapbuilder/diagnosis", "mapbuilder/evaluate"],
    "mapbuilder/upkeep": ["mapbuilder/diagnosis"],
    "mapbuilder/calibrate": ["mapbuilder/diagnosis"],
    "mapbuilder/print": ["core/camera", "core/marker"],
    "mapbuilder/commands": ["mapbuilder/report", "mapbuilder/print", "mapbuilder/upkeep", "mapbuilder/calibrate"],
    "simulator": ["core/capture", "manual"],
    "manual": [],
    "drivers": ["core/capture"],
    "locd": ["core/camera", "core/marker"],  # the words that all its rooms share
    "locd/main.cc": ["locd/service", "manual"],
    "locd/locdctl.cc": ["locd/control", "manual"],
    "locd/control": ["core/base"],
    "locd/frames": ["drivers", "locd"],
    "locd/pose": ["core/detect", "core/estimate", "locd/frames"],
    "locd/publish": ["locd/pose", "proto"],
    "locd/record": ["locd/publish"],
    "locd/service": ["locd/record"],
}

# Libraries that only some folders may see; every other folder that includes them is wrong.
ONLY_IN = {
    r"opencv2/|apriltag/": ["mapbuilder/referees"],
    r"lib(av|sw)[a-z]+/": ["mapbuilder/import"],
    r"ceres/": ["mapbuilder/bundle"],
    r"hpdf": ["mapbuilder/print"],
    r"lz4|zstd|sqlite3": ["mapbuilder/import"],
    r"lcm/lcm": ["locd/publish"],
    r"CLI/": ["manual", "mapbuilder", "simulator", "locd/main.cc", "locd/locdctl.cc"],
}


def reachable(folder):
    seen, todo = set(), [folder]
    while todo:
        here = todo.pop()
        if here in seen:
            continue
        seen.add(here)
        todo.extend(MAY_INCLUDE.get(here, []))
    return seen


def folder_of(path):
    """The table's folder (or file) that a path below the root belongs to, the longest that fits."""
    if path in MAY_INCLUDE:
        return path
    parts = pathlib.PurePosixPath(path).parent.parts
    for length in range(len(parts), 0, -1):
        name = "/".join(parts[:length])
        if name in MAY_INCLUDE or name == "proto":
            return name
    return None


def violations(files):
    """Messages for a mapping of path (below the root) to text."""
    for path, text in sorted(files.items()):
        own = folder_of(path)
        if own is None:
            yield f"{path}: its folder is not in the table of {pathlib.Path(__file__).name}; add it"
            continue
        allowed = reachable(own)
        for number, line in enumerate(text.splitlines(), 1):
            quoted = re.match(r'\s*#\s*include\s+"([^"]+)"', line)
            if quoted:
                target = folder_of(quoted.group(1))
                if target is None and "/" in quoted.group(1):
                    yield f"{path}:{number}: includes {quoted.group(1)}, which is in no known folder"
                elif target is not None and target not in allowed:
                    yield f"{path}:{number}: {own} must not include {target}"
            system = re.match(r"\s*#\s*include\s+<([^>]+)>", line)
            if system:
                for pattern, folders in ONLY_IN.items():
                    if re.match(pattern, system.group(1)) and own not in folders:
                        yield f"{path}:{number}: {own} must not include <{system.group(1)}>"


def check_table():
    for folder in MAY_INCLUDE:
        for below in MAY_INCLUDE[folder]:
            if folder in reachable(below):
                yield f"the table has a circle through {folder} and {below}"


def selftest():
    bad = {
        "core/base/a.h": '#include "core/map/marker_map.h"\n',
        "core/estimate/b.cc": '#include "mapbuilder/growth/growth.h"\n',
        "core/detect/c.cc": "#include <opencv2/aruco.hpp>\n",
        "core/geometry/d.cc": "#include <ceres/ceres.h>\n",
        "nowhere/e.cc": "\n",
    }
    good = {
        "core/map/a.h": '#include "core/base/error.h"\n#include <vector>\n',
        "mapbuilder/commands/b.cc": '#include "core/map/map_file.h"\n',
    }
    found = list(violations(bad))
    assert len(found) == len(bad), found
    assert not list(violations(good)), list(violations(good))


def main():
    selftest()
    root = pathlib.Path(sys.argv[1])
    files = {
        str(path.relative_to(root)): path.read_text(encoding="utf-8")
        for top in ("core", "drivers", "locd", "mapbuilder", "simulator")
        for path in (root / top).rglob("*")
        if path.suffix in (".h", ".cc")
    }
    found = list(check_table()) + list(violations(files))
    print("\n".join(found) or f"{len(files)} files include in the right directions")
    return 1 if found or not files else 0


if __name__ == "__main__":
    sys.exit(main())
