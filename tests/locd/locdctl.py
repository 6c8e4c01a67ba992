#!/usr/bin/env python3
"""locdctl against a locd that runs: every request, its text, its JSON and its exit code.

Usage: locdctl.py LOCD LOCDCTL MAPBUILDER SIMULATOR
"""

import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time


def main():
    locd, locdctl, mapbuilder, simulator = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        check(pathlib.Path(folder), locd, locdctl, mapbuilder, simulator)


def check(work, locd, locdctl, mapbuilder, simulator):
    def quietly(*command):
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    quietly(simulator, "detections", "--scene", "room1", "--rig", "cg60", "-o", work / "capture")
    quietly(mapbuilder, "build", work / "capture", "-o", work / "hall.map")
    (work / "locd.toml").write_text("""
[map]
path = "hall.map"
[rig]
camchain = "capture/rig.yaml"
[lcm]
url = "memq://"
[record]
min_free_bytes = 0
""" + "".join(f"""[[camera]]
name = "cam{i}"
driver = "replay"
device = "capture"
""" for i in range(3)), encoding="utf-8")
    environment = {**os.environ, "RUNTIME_DIRECTORY": str(work), "STATE_DIRECTORY": str(work)}

    def ask(*arguments, code=0):
        run = subprocess.run([locdctl, *arguments], env=environment, capture_output=True, text=True, check=False)
        assert run.returncode == code, (arguments, run)
        assert code == 0 or (run.stdout == "" and run.stderr), (arguments, run)
        return run

    ask("status", code=69)
    ask("no-such-request", code=64)
    ask("ignore", code=64)
    with open(work / "log", "w", encoding="utf-8") as log:
        service = subprocess.Popen([locd, "--config", work / "locd.toml"], env=environment, stderr=log)
    try:
        while not (work / "control").exists():
            assert service.poll() is None, (work / "log").read_text(encoding="utf-8")
            time.sleep(0.01)
        check_requests(work, ask)
    finally:
        service.send_signal(signal.SIGTERM)
        service.wait()
    ask("status", code=69)


def check_requests(work, ask):
    assert "not recording" in ask("status").stdout
    ask("mark", "nothing is recorded", code=69)
    assert json.loads(ask("--json", "status").stdout)["map_markers"] > 10
    folder = pathlib.Path(ask("start", "hall3").stdout.strip())
    assert folder.parent == work / "recordings" and folder.name.endswith("-hall3"), folder
    ask("start", code=64)
    ask("start", "a/b", code=64)
    ask("mark", "gate 4, open")
    assert json.loads(ask("status", "--json").stdout)["recording_path"] == str(folder)
    stopped = ask("stop")
    assert stopped.stdout.strip() == str(folder) and "marker" in stopped.stderr, stopped
    assert '"gate 4, open"' in (folder / "marks.csv").read_text(encoding="utf-8")
    assert "reloaded" in ask("reload").stdout
    ask("ignore", "5")
    assert json.loads(ask("status", "--json").stdout)["ignored"][0]["id"] == 5
    assert ":5" in ask("status").stdout
    ask("allow", "5")
    ask("allow", "5", code=65)
    ask("release", "5", code=65)
    ask("ignore", "five", code=65)
    given = ask("calibration")
    assert "camera_model: pinhole" in given.stdout and "does not calibrate" in given.stderr, given
    ask("calibration", "-o", str(work / "rig.yaml"))
    assert (work / "rig.yaml").read_text(encoding="utf-8") == given.stdout
    ask("calibration", "-o", str(work / "absent/rig.yaml"), code=73)
    (work / "locd.toml").write_text("[solve]\nnonsense = 1\n", encoding="utf-8")
    ask("reload", code=78)


if __name__ == "__main__":
    main()
