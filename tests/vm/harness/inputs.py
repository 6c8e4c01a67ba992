"""What a run works on, made natively: a capture that the cameras show, maps, the poses to be expected."""

import hashlib
import pathlib
import shutil
import subprocess

# A slow round of 13 positions, 5 cm apart: at one position a second the
# cameras' skew, tens of milliseconds in an emulated machine, is worth less than a few millimetres. A prime
# number, for a service that localizes every 2nd, 3rd, … set must not meet one image over and over.
ROUND = """[trajectory]
positions = 13
speed_mps = 0.05
look_from = "world"
waypoints = [
  { at_m = [6.80, 3.65, 1.25], look_deg = 60, pitch_deg = 0 },
  { at_m = [6.70, 3.75, 1.27], look_deg = 61, pitch_deg = 0 },
  { at_m = [6.60, 3.65, 1.25], look_deg = 60, pitch_deg = 1 },
  { at_m = [6.70, 3.55, 1.23], look_deg = 59, pitch_deg = 0 },
]
"""


def key_of(paths, *files):
    """Of all that goes into the inputs."""
    digest = hashlib.sha256()
    for file in (paths["simulator"], paths["mapbuilder"], paths["locd"], *files, __file__):
        digest.update(pathlib.Path(file).read_bytes())
    return digest.hexdigest()


def make_inputs(paths):
    """Fills the folder of inputs, unless all is there, made of the same."""
    folder = pathlib.Path(paths["inputs"])
    source = pathlib.Path(paths["source"])
    rig = source / "tests/vm/rig.yaml"
    scene = source / "simulator/scenes/room1.toml"
    key = key_of(paths, rig, scene)
    made_of = folder / "made_of"
    if made_of.exists() and made_of.read_text(encoding="utf-8") == key:
        return
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    # The scene library's room with one row of markers on each wall, for half the work in the guest.
    room = scene.read_text(encoding="utf-8")
    room = room.replace("rows_m = [0.80, 1.70]", "rows_m = [1.25]").replace("last = 59", "last = 29")
    (folder / "survey.toml").write_text(room, encoding="utf-8")
    (folder / "room.toml").write_text(room.partition("[trajectory]")[0] + ROUND, encoding="utf-8")

    def run(*command):
        subprocess.run([str(word) for word in command], cwd=folder, check=True, stdout=subprocess.DEVNULL)

    run(paths["simulator"], "render", "--scene", "room.toml", "--rig", rig, "-o", "capture")
    for name, noise in (("survey", 0.1), ("other", 0.2)):
        run(paths["simulator"], "detections", "--scene", "survey.toml", "--rig", rig, "--noise-px", noise, "-o", name)
    run(paths["mapbuilder"], "build", "survey", "-o", "room.map")
    # Another map of the same room, in the same frame.
    run(paths["mapbuilder"], "build", "other", "-o", "other.map", "--frame-of", "room.map")
    run(paths["locd"], "--replay", "capture", "--map", "room.map", "--trajectory", "expected.tum")
    made_of.write_text(key, encoding="utf-8")
