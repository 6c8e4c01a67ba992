"""A folder in which all is well, in which one input at a time is replaced, and programs that read it."""

import dataclasses
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import time

HANG_S = 120  # wall clock: far beyond the bound of processor time, for other programs may run beside
MEMORY_GUARD = 12 << 30  # keeps this machine alive; what meets it counts as big

RIG = """cam0:
  camera_model: pinhole
  intrinsics: [60.0, 60.0, 31.5, 23.5]
  distortion_model: none
  distortion_coeffs: []
  resolution: [64, 48]
"""
MARKERS = '[markers]\nfamily = "tag36h11"\nsize_m = 0.1\nignore = "99"\n'
CAPTURE = 'clock = "monotonic"\nsession = "a1"\nsync_tolerance_us = 1500\ncodec = "pgm"\nsoftware = "locd 1.0"\n'
CSV_HEADER = "t_ns,camera,marker_id,x0,y0,x1,y1,x2,y2,x3,y3\n"
DETECTIONS = CSV_HEADER + "".join(
    f"{1_000_000_000 + i * 100_000_000},cam0,{3 + i % 2},20,15,40,15,40,35,20,35\n" for i in range(8))
SURVEY = """[[points]]
id = 3
corner = "center"
position_m = [12.4, 3.05, 1.5]
sigma_m = 0.002
use = "check"
[[distances]]
from = { id = 3, corner = "bottom-left" }
to = { id = "tag36h11:4" }
distance_m = 6.017
sigma_m = 0.0016
"""
MAP_JSON = """{"schema": 1, "submaps": [{"frame": "facility", "markers": [
 {"id": 3, "family": "tag36h11", "size_m": 0.1, "position_m": [1, 2.5, 0], "sigma_m": 0.01, "sigma_deg": 1,
  "quaternion_xyzw": [0, 0, 0.7071, 0.7071]},
 {"id": 4, "family": "tag36h11", "size_m": 0.1, "position_m": [2, 2.5, 0], "sigma_m": 0.01, "sigma_deg": 1,
  "quaternion_xyzw": [0, 0, 0, 1]}]}]}
"""
CONFIG = """[map]
path = "good.map"
[rig]
camchain = "rig.yaml"
[[camera]]
name = "cam0"
driver = "replay"
device = "images"
[sync]
deadline_ms = 25
min_cameras = 1
[solve]
time_budget_ms = 100
ok_sigma_m = 0.02
v_max_mps = 3.0
[lcm]
url = "memq://"
channel_prefix = "WAYMARK"
[record]
codec = "pgm"
every_nth = 2
max_bytes = 1000000
[service]
startup_wait_s = 5.0
realtime = false
lock_memory = false
"""


def pgm(width, height):
    return f"P5\n{width} {height}\n255\n".encode() + bytes((x + y) % 256 for y in range(height) for x in range(width))


def bytes_on_disk(path):
    """Of a file, or of all that lies below a folder, names included."""
    path = pathlib.Path(path)
    if not os.path.lexists(path):
        return 0
    if path.is_symlink() or not path.is_dir():
        state = path.lstat()
        return min(state.st_size, state.st_blocks * 512) + len(path.name)
    return sum(bytes_on_disk(below) for below in path.iterdir()) + len(path.name)


@dataclasses.dataclass
class Run:
    """How a program ended. Of a process: `seconds` of processor time, `kilobytes` at most resident."""
    code: int | None  # None: it was still running
    seconds: float
    kilobytes: int
    errors: bytes


class Stand:
    def __init__(self, folder, mapbuilder, locd):
        self.folder = pathlib.Path(folder)
        self.mapbuilder, self.locd = str(mapbuilder), str(locd)
        self.files = {"rig.yaml": RIG, "markers.toml": MARKERS, "capture.toml": CAPTURE,
                      "detections.csv": DETECTIONS, "survey.toml": SURVEY, "map.json": MAP_JSON,
                      "locd.toml": CONFIG}
        for name, text in self.files.items():
            (self.folder / name).write_text(text, encoding="utf-8")
        made = self.run([self.mapbuilder, "import", self.folder / "map.json", "-o", self.folder / "good.map"])
        if made.code != 0:
            raise SystemExit(f"{self.mapbuilder}: {made.errors.decode()}")
        self.make_capture("images", {"100000000.pgm": pgm(64, 48), "200000000.pgm": pgm(64, 48)})
        self.baselines = {}

    def text(self, name):
        return self.files[name].encode()

    def make_capture(self, name, images=None, **files):
        """A capture folder, of images or of a table; `files` by the name before their dot replace its own."""
        folder = self.folder / name
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        names = ["rig.yaml", "markers.toml", "capture.toml"] + (["detections.csv"] if images is None else [])
        for file in names:
            (folder / file).write_bytes(files.get(file.split(".")[0], self.text(file)))
        if images is not None:
            (folder / "cam0").mkdir()
            for image, content in images.items():
                (folder / "cam0" / image).write_bytes(content)
        return folder

    def run(self, arguments, cpu_limit_s=None):
        """Runs a program to its end, or for HANG_S."""
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY_GUARD, MEMORY_GUARD))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        with open(self.folder / "stderr", "w+b") as errors:
            process = subprocess.Popen([str(a) for a in arguments], stdin=subprocess.DEVNULL,
                                       stdout=subprocess.DEVNULL, stderr=errors, preexec_fn=limit, cwd=self.folder)
            deadline = time.monotonic() + HANG_S
            code = None
            while code is None:
                pid, status, usage = os.wait4(process.pid, os.WNOHANG)
                if pid:
                    code = os.waitstatus_to_exitcode(status)
                elif time.monotonic() > deadline:
                    process.send_signal(signal.SIGKILL)
                    _, status, usage = os.wait4(process.pid, 0)
                    break
                else:
                    time.sleep(0.002)
            process.returncode = 0  # waited for above
            errors.seek(0)
            return Run(code, usage.ru_utime + usage.ru_stime, usage.ru_maxrss, errors.read(1 << 20))

    # What reads an input, once it lies at `path`; each gives the arguments.
    def check(self, path):
        return [self.locd, "--config", path, "--check"]

    def check_with(self, key, path):
        """locd.toml, in which one file is another."""
        own = {"path": "good.map", "camchain": "rig.yaml"}[key]
        config = self.folder / "with.toml"
        config.write_text(CONFIG.replace(f'{key} = "{own}"', f'{key} = "{path}"'), encoding="utf-8")
        return self.check(config)

    def info(self, path):
        return [self.mapbuilder, "info", path]

    def import_map(self, path):
        return [self.mapbuilder, "import", path, "-o", self.folder / "imported.map"]

    def replay(self, capture):
        return [self.locd, "--replay", capture, "--map", self.folder / "good.map"]

    def detect(self, capture):
        return [self.mapbuilder, "detect", capture, "-o", self.folder / "detected.csv", "--threads", "1"]

    def build(self, capture, *options):
        return [self.mapbuilder, "build", capture, "-o", self.folder / "built.map", "--threads", "1", *options]

    def evaluate(self, truth):
        return [self.mapbuilder, "evaluate", "--map", self.folder / "good.map", "--truth", truth]

    def localize(self, quarantine):
        return [self.mapbuilder, "localize", self.make_capture("localized"), "--map", self.folder / "good.map",
                "--trajectory", self.folder / "poses.tum", "--quarantine", quarantine, "--threads", "1"]
