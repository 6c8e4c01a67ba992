#include "locd/publish/clock_offset.h"

#include <sys/timex.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>

namespace waymark {
namespace {

Stamp read_clock(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return std::chrono::seconds(now.tv_sec) + std::chrono::nanoseconds(now.tv_nsec);
}

/// Whether a time service keeps the wall clock. The kernel tells, where a sandbox lets it be asked;
/// systemd's own service tells by a file.
bool is_vouched_for() {
  timex clock{};
  if (::adjtimex(&clock) != -1 && (clock.status & STA_UNSYNC) == 0) return true;
  return ::access("/run/systemd/timesync/synchronized", F_OK) == 0;
}

Stamp wall_minus_monotonic(const ClockReading& reading) { return reading.wall - reading.monotonic; }

Stamp part_per_million(Stamp interval, double ppm) {
  return Stamp(static_cast<Stamp::rep>(static_cast<double>(interval.count()) * ppm * 1e-6));
}

}  // namespace

ClockReading read_clocks() {
  ClockReading best;
  Stamp best_span = Stamp::max();
  // The thread may be moved aside between two readings: the tightest of three tries is taken.
  for (int i = 0; i < 3; ++i) {
    const Stamp before = read_clock(CLOCK_MONOTONIC);
    const Stamp wall = read_clock(CLOCK_REALTIME);
    const Stamp boottime = read_clock(CLOCK_BOOTTIME);
    const Stamp after = read_clock(CLOCK_MONOTONIC);
    if (after - before < best_span) {
      best_span = after - before;
      best = {before + best_span / 2, boottime, wall};
    }
  }
  best.vouched_for = is_vouched_for();
  return best;
}

ClockOffset::ClockOffset(const ClockReading& start)
    : last_(start),
      offset_(wall_minus_monotonic(start)),
      status_(start.wall < kEarliestDate ? TimeStatus::unset : TimeStatus::ok) {}

ClockEvent ClockOffset::update(const ClockReading& now) {
  const Stamp elapsed = std::max(Stamp{0}, now.monotonic - last_.monotonic);
  const Stamp moved = wall_minus_monotonic(now) - wall_minus_monotonic(last_);
  const Stamp slept = (now.boottime - now.monotonic) - (last_.boottime - last_.monotonic);
  const Stamp allowed = kStep + part_per_million(elapsed, kMaxDrift_ppm);
  last_ = now;

  const Stamp slew = part_per_million(std::min(elapsed, kLongestSlew), kMaxSlew_ppm);
  offset_ += std::clamp(wall_minus_monotonic(now) - offset_, -slew, slew);

  if (std::chrono::abs(moved) > allowed || slept > allowed) {
    ++steps_;
    if (status_ != TimeStatus::unset) {
      status_ = slept > allowed ? TimeStatus::suspended : TimeStatus::stepped;
    }
    return slept > allowed ? ClockEvent::slept : ClockEvent::stepped;
  }
  const bool follows = std::chrono::abs(error()) <= kTolerance;
  // Unset stays: utime was no date when the session began.
  if (status_ == TimeStatus::unset) return ClockEvent::none;
  if (follows) {
    status_ = TimeStatus::ok;
  } else if (status_ == TimeStatus::ok) {
    status_ = TimeStatus::slewing;
  }
  return ClockEvent::none;
}

std::int64_t ClockOffset::utime_us(Stamp stamp) const {
  return std::chrono::floor<std::chrono::microseconds>(stamp + offset_).count();
}

Stamp ClockOffset::error() const { return wall_minus_monotonic(last_) - offset_; }

bool ClockOffset::date_known() const {
  return last_.vouched_for && std::chrono::abs(error()) <= kDateTolerance;
}

}  // namespace waymark
