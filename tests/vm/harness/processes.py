"""Processes that outlive the test that started them, found again by number: only while they work in the folder
that they were started in, for a number comes back for somebody else's, and the dead keep theirs for a while."""

import os
import pathlib
import signal
import time


def living(group, folder):
    """Numbers of a process group's members that work in `folder`."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and os.getpgid(int(entry.name)) == group and \
                    os.readlink(entry / "cwd") == os.path.realpath(folder):
                found.append(int(entry.name))
        except OSError:  # it has ended meanwhile, or is dead
            pass
    return found


def end(group, folder, how=signal.SIGTERM, patience_s=10):
    """Ends a process group and returns when nothing of it lives; what does not end in time is killed."""
    deadline = time.monotonic() + patience_s
    while living(group, folder):
        try:
            os.killpg(group, how)
        except ProcessLookupError:
            return
        if time.monotonic() > deadline:
            if how == signal.SIGKILL:
                raise TimeoutError(f"process group {group} can't be killed")
            how, deadline = signal.SIGKILL, time.monotonic() + patience_s
        time.sleep(0.05)
