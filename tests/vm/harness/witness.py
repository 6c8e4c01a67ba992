"""What guest/witness.cc recorded: whether the machine itself stood still, and what locd did, at any time."""

import bisect
import json
import pathlib

RECORD = "/run/witness.jsonl"


class Witness:
    def __init__(self, world):
        self.world = world
        self.stalls = []   # (from, to) of a processor, s of the guest's CLOCK_MONOTONIC
        self.samples = []  # of locd, oldest first
        self.times = []

    def begin(self):
        self.world.guest.check("systemctl stop witness 2>/dev/null; "
                               f"systemd-run --quiet --unit=witness /share/bin/vm_witness {RECORD}")

    def end(self):
        """Stops it and reads what it wrote."""
        self.world.guest.check(f"systemctl stop witness; mv {RECORD} /share/witness.jsonl", timeout_s=120)
        self.read(pathlib.Path(self.world.share) / "witness.jsonl")

    def read(self, file):
        for line in file.read_text(encoding="utf-8").splitlines():
            entry = json.loads(line)
            if "cpu" in entry:
                self.stalls.append((entry["from_s"], entry["to_s"]))
            else:
                self.samples.append(entry)
        self.times = [s["at_s"] for s in self.samples]

    def between(self, begin, end):
        """Of a time: {what: s}, each moment once. stood_still: a processor ran nothing; at_work: a thread of locd's ran,
        or waited for a processor; starting: there was no locd, and others were at work; absent: there was none, and
        nobody was; the rest it waited for something else."""
        spent = {"stood_still": 0.0, "at_work": 0.0, "starting": 0.0, "absent": 0.0, "waited": 0.0}
        for a, b in self._intervals(begin, end):
            still = self._stood_still(max(begin, a["at_s"]), min(end, b["at_s"]))
            rest = min(end, b["at_s"]) - max(begin, a["at_s"]) - still
            at_work = b["at_work"] > 0
            what = ("starting" if at_work else "absent") if b["pid"] == 0 else "at_work" if at_work else "waited"
            spent["stood_still"] += still
            spent[what] += rest
        return spent

    def of_service_thread(self, begin, end):
        """How much of a time the service thread had something to do and could not be done with it: it ran or waited
        for a processor, or the machine stood still (s); and the functions of the kernel in which it slept."""
        held_up, asleep_in = 0.0, set()
        for a, b in self._intervals(begin, end):
            part = (min(end, b["at_s"]) - max(begin, a["at_s"])) / (b["at_s"] - a["at_s"])
            busy = 0.0
            if a["pid"] == b["pid"] != 0:
                busy = part * (b["ran_s"] - a["ran_s"] + b["waited_s"] - a["waited_s"])
                asleep_in.add(b["in"])
            still = self._stood_still(max(begin, a["at_s"]), min(end, b["at_s"]))
            held_up += min(max(still, busy), part * (b["at_s"] - a["at_s"]))
        return held_up, sorted(asleep_in - {"0", ""})

    def _intervals(self, begin, end):
        first = max(bisect.bisect_right(self.times, begin) - 1, 0)
        last = min(bisect.bisect_left(self.times, end) + 1, len(self.samples))
        return list(zip(self.samples[first:last], self.samples[first + 1:last]))

    def _stood_still(self, begin, end):
        """s of a time in which a processor or another ran nothing."""
        total, reached = 0.0, begin
        for since, until in sorted(s for s in self._stalls_near(begin, end)):
            since, until = max(since, reached), min(until, end)
            total += max(until - since, 0)
            reached = max(reached, until)
        return total

    def _stalls_near(self, begin, end):
        return [(since, until) for since, until in self.stalls if since < end and until > begin]
