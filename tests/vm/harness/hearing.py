"""What the guest's listener heard on LCM: JSON lines in the shared folder."""

import json
import os
import pathlib
import time

# pose_t.status and reasons, camera_status_t.state, status_t.time_status (proto/).
OK, DEGRADED, AMBIGUOUS, LOST = range(4)
NO_FRAMES, CAMERA_MISSING, UNSYNCED = 1, 256, 2048
WAITING, STREAMING, STALLED, CAMERA_LOST = range(4)
TIME_OK, TIME_SLEWING, TIME_STEPPED, TIME_SUSPENDED = range(4)

# How much longer tests wait than what they wait for takes, for machines that have other work: it costs time
# only when something fails.
PATIENCE = float(os.environ.get("WAYMARK_VM_PATIENCE", "4"))


class NotHeard(Exception):
    pass


class Hearing:
    """Messages from now on; each look at them starts where `mark` was last called."""

    def __init__(self, share):
        self.file = pathlib.Path(share) / "heard.jsonl"
        self.begin = 0
        self.mark()

    def mark(self):
        """Forgets what was heard so far."""
        self.begin = self.file.stat().st_size if self.file.exists() else 0

    def _whole_lines(self):
        if not self.file.exists():
            return b""
        with open(self.file, "rb") as file:
            file.seek(self.begin)
            text = file.read()
        # A line under way has no end yet.
        return text[:text.rfind(b"\n") + 1]

    def since_mark(self, kind=None):
        """Messages of a kind (POSE, STATUS, ALERT), oldest first."""
        return self._messages(self._whole_lines(), kind)

    def take(self, kind=None):
        """The same, each of them once: the mark moves behind what was read, and no further."""
        text = self._whole_lines()
        self.begin += len(text)
        return self._messages(text, kind)

    @staticmethod
    def _messages(text, kind):
        messages = [json.loads(line) for line in text.splitlines()]
        return [m for m in messages if kind is None or m["channel"] == f"WAYMARK_{kind}"]

    def wait_for(self, what, kind, fits, timeout_s=60, count=1):
        """The first `count` messages since the mark that fit; NotHeard, with the last of the kind, when time is up."""
        deadline = time.monotonic() + timeout_s * PATIENCE
        while True:
            messages = self.since_mark(kind)
            found = [m for m in messages if fits(m)]
            if len(found) >= count:
                return found[0] if count == 1 else found[:count]
            if time.monotonic() > deadline:
                last = json.dumps(messages[-1]) if messages else "none at all"
                raise NotHeard(f"no {what} within {timeout_s} s; {len(messages)} {kind} messages, the last: {last}")
            time.sleep(0.1)
