#!/usr/bin/env python3
"""What a program printed and nobody got is an error (EX_IOERR); an error that nobody reads is still that error.

Usage: standard_output.py LOCD MAPBUILDER SIMULATOR
"""

import pathlib
import subprocess
import sys
import tempfile

import hundred_sets

IO = 74
NO_INPUT = 66
USAGE = 64


def exit_code(command, folder, out="/dev/null", err="/dev/null"):
    with open(out, "wb") as stdout, open(err, "wb") as stderr:
        return subprocess.run(command, cwd=folder, stdout=stdout, stderr=stderr, timeout=120, check=False).returncode


def main():
    locd, mapbuilder, simulator = (str(pathlib.Path(program).resolve()) for program in sys.argv[1:4])
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        hundred_sets.write_inputs(folder, "memq://")
        room = [simulator, "detections", "--scene", "room1", "--rig", "mono", "--positions", "20", "-o"]
        assert exit_code(room + ["room"], folder) == 0
        assert exit_code([mapbuilder, "build", "room", "-o", "room.map"], folder) == 0
        assert exit_code([mapbuilder, "export", "room.map", "--format", "json", "-o", "room.json"], folder) == 0
        assert exit_code([mapbuilder, "edit", "room.map", "-o", "less.map", "--remove", "0"], folder) == 0
        printing = [
            [locd, "--help"],
            [locd, "--version"],
            [locd, "--replay", "room", "--map", "room.map"],
            [locd, "--config", "locd.toml", "--check"],
            [mapbuilder, "--help"],
            [mapbuilder, "--version"],
            [mapbuilder, "build", "--help"],
            [mapbuilder, "build", "room", "-o", "again.map"],
            [mapbuilder, "localize", "room", "--map", "room.map", "--trajectory", "rig.tum"],
            [mapbuilder, "info", "room.map"],
            [mapbuilder, "info", "room.map", "--json"],
            [mapbuilder, "info", "room.map", "--distance", "1", "2"],
            [mapbuilder, "diff", "room.map", "less.map"],
            [mapbuilder, "diff", "room.map", "less.map", "--json"],
            [mapbuilder, "edit", "room.map", "-o", "less.map", "--remove", "1"],
            [mapbuilder, "import", "room.json", "-o", "again.map"],
            [mapbuilder, "print", "--family", "tag36h11", "--ids", "0-3", "--size-m", "0.1", "-o", "markers.pdf"],
            [mapbuilder, "print", "--advise", "--rig", "room/rig.yaml", "--range-m", "8"],
            [mapbuilder, "evaluate", "--map", "room.map", "--truth", "room/groundtruth"],
            [simulator, "--help"],
            [simulator, "list"],
        ]
        failing = [
            (NO_INPUT, [locd, "--replay", "absent", "--map", "room.map"]),
            (NO_INPUT, [locd, "--config", "absent.toml", "--check"]),
            (USAGE, [locd]),
            (USAGE, [locd, "--what"]),
            (NO_INPUT, [mapbuilder, "info", "absent.map"]),
            (USAGE, [mapbuilder, "what"]),
            (NO_INPUT, [simulator, "render", "--scene", "absent", "--rig", "mono", "-o", "out"]),
        ]
        wrong = []
        for command in printing:
            for out, expected in (("/dev/null", 0), ("/dev/full", IO)):
                code = exit_code(command, folder, out=out)
                if code != expected:
                    wrong.append(f"{' '.join(command)} > {out}: {code} instead of {expected}")
        for expected, command in failing:
            code = exit_code(command, folder, out="/dev/full", err="/dev/full")
            if code != expected:
                wrong.append(f"{' '.join(command)} 2> /dev/full: {code} instead of {expected}")
        print("\n".join(wrong) or f"{len(printing)} commands end as what they print does")
        return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
