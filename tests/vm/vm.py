#!/usr/bin/env python3
"""Starts the virtual machine, runs a scenario in it, ends it: what ctest calls.

Usage: vm.py PATHS.json start | end | SCENARIO
A scenario is a function of a module in scenarios/, named as its test.
"""

import pathlib
import shutil
import subprocess
import sys
import time
import traceback

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE / "harness"), str(HERE / "scenarios")]

# pylint: disable=wrong-import-position
import capture_paths
import chaos
import devices
import disks
import package
import poses
import sandbox
import service_faults
import starting
from inputs import make_inputs
from world import load

SCENARIOS = (package, poses, starting, devices, service_faults, sandbox, disks, capture_paths, chaos)


def make_packages(paths, folder):
    """The .debs as users get them, of the programs as they were built, under their names without version."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    subprocess.run([paths["cpack"], "-G", "DEB", "--config", paths["cpack_config"], "-B", folder],
                   check=True, stdout=subprocess.DEVNULL)
    for package_file in folder.glob("*.deb"):
        package_file.rename(folder / f"{package_file.name.partition('_')[0]}.deb")


def start(world):
    began = time.monotonic()

    def say(what):
        print(f"{time.monotonic() - began:6.1f} s  {what}", flush=True)

    end(world)
    shutil.rmtree(world.run, ignore_errors=True)
    world.run.mkdir(parents=True)
    packages = world.run / "packages"
    make_packages(world.paths, packages)
    say("packed")
    make_inputs(world.paths)
    say("capture and maps made")
    image = subprocess.run([HERE / "image/build", packages / "waymark-locd.deb"], check=True,
                           stdout=subprocess.PIPE, text=True)
    say("image there")
    world.machine.assemble(*image.stdout.split())
    for package_file in packages.glob("*.deb"):
        shutil.copy(package_file, world.share)
    (world.share / "bin").mkdir()
    for tool in ("vm_listener", "vm_hold_thread", "vm_feed", "vm_capture", "vm_witness"):
        shutil.copy(world.paths[tool], world.share / "bin")
    print(world.boot())
    say("guest up")


def end(world):
    world.cut_power()


def scenario_named(name):
    found = [getattr(module, name) for module in SCENARIOS if hasattr(module, name)]
    if len(found) != 1:
        sys.exit(f"there is no scenario {name}")
    return found[0]


def run_scenario(name, world):
    """Runs it; once more in a fresh guest where the guest's kernel has panicked. The stock kernel's uvcvideo does at
    times when cameras leave, whatever reads them; a panic each time is a failure."""
    try:
        scenario_named(name)(world)
    except Exception:  # pylint: disable=broad-exception-caught
        if not world.machine.has_panicked():
            raise
        traceback.print_exc()
        print("\nThe guest's kernel has panicked; once more:\n" + world.machine.last_words())
        world.machine.kill()
        again = load(sys.argv[1])
        print(again.boot())
        scenario_named(name)(again)


def main():
    world = load(sys.argv[1])
    action = sys.argv[2]
    if action == "end":
        end(world)
        return 0
    try:
        if action == "start":
            start(world)
        else:
            run_scenario(action, world)
        return 0
    except Exception:  # pylint: disable=broad-exception-caught  # whatever it is, the test fails and says it
        traceback.print_exc()
        print("\nThe guest's console ends with:\n" + world.machine.last_words())
        try:
            print("\nlocd's log ends with:\n" + world.locd.journal())
            world.locd.stop()  # The next one begins anew, with a configuration of its own.
        except Exception as unreachable:  # pylint: disable=broad-exception-caught
            print(f"\nlocd's log: {unreachable}")
        return 1


if __name__ == "__main__":
    sys.exit(main())
