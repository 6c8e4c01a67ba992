#include "locd/frames/stamp_guard.h"

#include <algorithm>

#include "core/base/check.h"

namespace waymark {
namespace {

/// A gap of more periods tells no more of them (2–100).
constexpr int kLongestGap = 8;

}  // namespace

Status StampGuardOptions::check() const {
  return RangeCheck()
      .field("delay in us", in_us(delay), kDelay_us)
      .field("future in ms", in_us(future) / 1e3, {0, 100})
      .field("oldest_periods", oldest_periods, {1, 100})
      .field("distrust_after", distrust_after, {1, 1000})
      .field("trust_after", trust_after, {1, 10'000})
      .status();
}

StampGuard::StampGuard(const StampGuardOptions& options) : options_(options) {
  WAYMARK_CHECK(options.check().has_value());
}

bool StampGuard::believable(Stamp stamp, Stamp arrival) const {
  if (stamp > arrival + options_.future) return false;
  if (period_ > Stamp{0} && stamp < arrival - options_.oldest_periods * period_) return false;
  return !last_device_ || stamp > *last_device_;
}

bool StampGuard::learn_period(Stamp arrival) {
  if (!last_arrival_) {
    last_arrival_ = arrival;
    return false;
  }
  const Stamp since = arrival - *last_arrival_;
  last_arrival_ = arrival;
  if (period_ == Stamp{0}) {
    period_ = since;
    return false;
  }
  const Stamp least = period_ / 2;
  period_ += (std::clamp<Stamp>(since, least, kLongestGap * period_) - period_) / 8;
  return since < least;
}

bool StampGuard::admit(Frame& frame, Stamp arrival) {
  const Stamp stamp = frame.stamp() - options_.delay;
  const bool fine = believable(stamp, arrival);
  if (!learn_period(arrival)) in_a_row_ = fine == unsynced_ ? in_a_row_ + 1 : 0;
  const bool turns = in_a_row_ >= (unsynced_ ? options_.trust_after : options_.distrust_after);
  // What can't be believed is no measure for the next, unless it goes on: clocks may be set back.
  if (fine || unsynced_ || turns) last_device_ = stamp;
  if (turns) {
    unsynced_ = !unsynced_;
    in_a_row_ = 0;
  }
  if (!fine && !unsynced_) return false;
  const Stamp used = unsynced_ ? arrival : stamp;
  if (last_stamp_ && used <= *last_stamp_) return false;
  last_stamp_ = used;
  frame.set_stamp(used, unsynced_ ? StampQuality::arrival : frame.info().quality);
  return true;
}

}  // namespace waymark
