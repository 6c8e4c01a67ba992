"""A rig of one camera that sees nothing, a hundred times a second: many messages of little work."""

import os
import subprocess

CONFIG = """[rig]
camchain = "capture/rig.yaml"
[[camera]]
name = "cam0"
driver = "replay"
device = "capture"
[lcm]
url = "{url}"
{lcm}
"""
RIG = """cam0:
  camera_model: pinhole
  intrinsics: [300.0, 300.0, 319.5, 239.5]
  distortion_model: radtan
  distortion_coeffs: [0, 0, 0, 0]
  resolution: [640, 480]
"""
MARKERS = '[markers]\nfamily = "tag36h11"\nsize_m = 0.2\n'
HEADER = "t_ns,camera,marker_id,x0,y0,x1,y1,x2,y2,x3,y3"
STAMPS_NS = [i * 10_000_000 for i in range(1, 201)]


def write_inputs(folder, url, lcm=""):
    capture = folder / "capture"
    capture.mkdir()
    (capture / "rig.yaml").write_text(RIG, encoding="utf-8")
    (capture / "markers.toml").write_text(MARKERS, encoding="utf-8")
    rows = [HEADER] + [f"{t},cam0,,,,,,,,," for t in STAMPS_NS]
    (capture / "detections.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    (folder / "locd.toml").write_text(CONFIG.format(url=url, lcm=lcm), encoding="utf-8")


def start(locd, folder, log, **environment):
    """locd in the folder, its log in a file of it."""
    own = dict(os.environ, RUNTIME_DIRECTORY=str(folder), STATE_DIRECTORY=str(folder), **environment)
    return subprocess.Popen([locd, "--config", folder / "locd.toml"], env=own, stderr=log)
