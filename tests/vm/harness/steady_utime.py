"""Whether utime goes on as if nothing were when somebody sets the machine's clock or the machine sleeps."""

from hearing import Hearing

# utime follows the machine's clock by so much of the time gone by.
SLEW = 500e-6
# It does so in steps, as far apart on a machine that stands still.
STANDSTILL_S = 20
# s by which utime, as another process sees it, may change: that hears late at times, but not always.
HEARD_S = 2


def delay_s(message):
    """From utime, when the message was made, to when it was heard, plus what is the same for all of a session."""
    return message["heard_s"] - message.get("utime_published", message["utime"]) / 1e6


def slew_s(a, b):
    """By which utime may have followed the machine's clock from one status to another."""
    return SLEW * (b["uptime_s"] - a["uptime_s"] + STANDSTILL_S)


class SteadyUtime:
    """utime of a running session, from now on."""

    def __init__(self, world):
        self.hearing = Hearing(world.share)
        self.first, *others = self.hearing.wait_for("status", "STATUS", lambda m: True, count=3)
        self.delay_s = min(delay_s(m) for m in (self.first, *others))

    def check(self):
        """Every interval between two statuses is as long by utime as by the clock that nobody sets: locd read both
        at one instant, so that a machine that stands still changes nothing. And poses' utime is what it was to
        somebody who has a clock of his own."""
        statuses = self.hearing.since_mark("STATUS")
        for a, b in zip(statuses, statuses[1:]):
            assert b["session"] == self.first["session"], "it was restarted"
            by_uptime_s = b["uptime_s"] - a["uptime_s"]
            by_utime_s = (b["utime"] - a["utime"]) / 1e6
            assert abs(by_utime_s - by_uptime_s) < slew_s(a, b), \
                f"utime went on by {by_utime_s} s in {by_uptime_s} s, to {b}"
        now = Hearing(self.hearing.file.parent)
        now.wait_for(f"pose whose utime is as before within {HEARD_S} s", "POSE",
                     lambda m: m["cameras_used"] == m["cameras"] and abs(delay_s(m) - self.delay_s) < HEARD_S)
