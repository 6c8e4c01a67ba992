"""Commands in the guest, by its agent (image/guest/waymark-agent)."""

import base64
import os
import pathlib
import socket
import time

from hearing import PATIENCE


class GuestError(Exception):
    pass


class Guest:
    def __init__(self, run):
        self.run_folder = pathlib.Path(run)
        self.last_id = 0
        self.agent = None  # connected with the first command, for all of this process

    def _connect(self):
        agent = socket.socket(socket.AF_UNIX)
        # Socket paths are short only as seen from the run folder.
        here = os.open(".", os.O_RDONLY)
        try:
            os.chdir(self.run_folder)
            agent.connect("agent.sock")
        except OSError:
            agent.close()
            raise
        finally:
            os.fchdir(here)
            os.close(here)
        return agent

    def hang_up(self):
        """The agent is gone; the next command asks for another."""
        self.agent = None

    def run(self, command, timeout_s=60):
        """(exit code, output) of a command of POSIX's shell; of `timeout_s` exceeded, GuestError."""
        self.last_id += 1
        request = f"{os.getpid()}.{self.last_id}"
        deadline = time.monotonic() + timeout_s * PATIENCE
        if self.agent is None:
            self.agent = self._connect()
        self.agent.sendall(f"{request} {base64.b64encode(command.encode()).decode()}\n".encode())
        return self._answer(self.agent, request, command, deadline)

    @staticmethod
    def _answer(agent, request, command, deadline):
        received = b""
        while True:
            left = deadline - time.monotonic()
            if left <= 0:
                raise GuestError(f"the guest gave no answer in time to: {command}")
            agent.settimeout(left)
            try:
                chunk = agent.recv(1 << 16)
            except TimeoutError:
                continue
            if not chunk:
                raise GuestError("the machine is gone")
            received += chunk
            *lines, received = received.split(b"\n")
            for line in lines:
                words = line.decode().split(" ")
                # Answers to somebody who waited no longer are passed over.
                if words[0] == request:
                    return int(words[1]), base64.b64decode(words[2]).decode(errors="replace").rstrip("\n")

    def check(self, command, timeout_s=60):
        """Output of a shell command that must succeed."""
        code, output = self.run(command, timeout_s)
        if code != 0:
            raise GuestError(f"in the guest, exit code {code} of: {command}\n{output}")
        return output
