#!/usr/bin/env python3
"""Holds what a program links to a list, so that nothing heavy creeps in.

Usage: linked_libraries.py PROGRAM ALLOWED…
ALLOWED are names as in libNAME.so; what the program itself needs must be among them. Whatever is
pulled in behind must not be of FORBIDDEN.
"""

import re
import subprocess
import sys

# Other detectors, windows, videos: each start costs 70 MB and 0.1–0.2 s, each installation 300 packages.
FORBIDDEN = r"libopencv|libapriltag|libgtk|libQt|libavcodec|libavformat"


def needed(program):
    text = subprocess.run(["readelf", "-d", program], check=True, capture_output=True, text=True)
    return re.findall(r"\(NEEDED\).*\[lib([^\]]+?)\.so", text.stdout)


def loaded(program):
    text = subprocess.run(["ldd", program], check=True, capture_output=True, text=True)
    return re.findall(r"^\s*(\S+)", text.stdout, re.M)


def main():
    program, allowed = sys.argv[1], set(sys.argv[2:])
    direct = needed(program)
    assert direct, "readelf told nothing"
    wrong = [f"links lib{name}.so, which is not in the list" for name in direct
             if name not in allowed]
    wrong += [f"loads {name}" for name in loaded(program) if re.match(FORBIDDEN, name)]
    print("\n".join(wrong) or f"{program}: {len(direct)} libraries, all in the list")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
