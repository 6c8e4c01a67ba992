"""The emulated USB cameras: processes of their own, plugged in by being started, unplugged by being ended."""

import os
import pathlib
import socket
import subprocess
import time

import processes
from hearing import PATIENCE
from machine import LIFETIME_S

COUNT = 3


class Camera:
    """Camera `number` of the rig, whose serial number is WM-`number`."""

    def __init__(self, run, paths, number):
        self.run = pathlib.Path(run)
        self.program = paths["uvc_camera"]
        self.images = pathlib.Path(paths["inputs"]) / "capture" / f"cam{number}"
        self.serial = f"WM-{number}"
        self.pid_file = self.run / f"{self.serial}.pid"
        self.control = f"{self.serial}.control"

    def plug(self, port, fps=1.0, mjpeg=False):
        """Into USB port `port`; QEMU looks for the camera once a second."""
        self.unplug()
        command = ["timeout", str(LIFETIME_S), self.program, "--socket", f"camera{port}.sock",
                   "--control", self.control, "--images", self.images, "--serial", self.serial,
                   "--fps", str(fps)]
        with open(self.run / f"{self.serial}.log", "ab") as log:
            process = subprocess.Popen(command + (["--mjpeg"] if mjpeg else []), cwd=self.run,
                                       stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                                       start_new_session=True)
        self.pid_file.write_text(f"{process.pid} {port}", encoding="utf-8")

    def _process_and_port(self):
        """Of the camera as it is plugged in; nothing of one that is not."""
        try:
            return [int(word) for word in self.pid_file.read_text(encoding="utf-8").split()]
        except (OSError, ValueError):
            return None, None

    def unplug(self):
        group = self._process_and_port()[0]
        if group is None:
            return
        processes.end(group, self.run)
        self.pid_file.unlink()

    def _connect(self, control):
        """To the socket that the camera opens soon after it was plugged in."""
        deadline = time.monotonic() + 10 * PATIENCE
        while True:
            try:
                control.connect(self.control)
                return
            except OSError:
                if time.monotonic() > deadline:
                    raise
                time.sleep(0.1)

    def port(self):
        """Where it is plugged in; None: nowhere."""
        return self._process_and_port()[1]

    def order(self, text):
        """The emulator's answer to an order, see uvc_camera/uvc_device.h."""
        here = os.open(".", os.O_RDONLY)
        os.chdir(self.run)
        try:
            with socket.socket(socket.AF_UNIX) as control:
                control.settimeout(10 * PATIENCE)
                self._connect(control)
                control.sendall(text.encode() + b"\n")
                answer = b""
                while not answer.endswith(b"\n"):
                    chunk = control.recv(4096)
                    if not chunk:
                        break
                    answer += chunk
        finally:
            os.fchdir(here)
            os.close(here)
        answer = answer.decode().strip()
        if answer.startswith("error"):
            raise ValueError(f"{self.serial}: {text}: {answer}")
        return answer
