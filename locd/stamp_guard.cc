#include "locd/stamp_guard.h"

namespace waymark {

bool StampGuard::believable(Stamp stamp, Stamp now) const {
  if (stamp > now + options_.future) return false;
  if (period_ > Stamp{0} && stamp < now - options_.oldest_periods * period_) return false;
  return !last_device_ || stamp > *last_device_;
}

bool StampGuard::admit(Frame& frame, Stamp now) {
  if (last_arrival_) {
    const Stamp since = now - *last_arrival_;
    period_ = period_ == Stamp{0} ? since : period_ + (since - period_) / 8;
  }
  last_arrival_ = now;
  const Stamp stamp = frame.stamp() - options_.delay;
  const bool fine = believable(stamp, now);
  // What can't be believed is no measure for the next, unless it goes on: clocks may be set back.
  if (fine || unsynced_ || in_a_row_ + 1 >= options_.distrust_after) last_device_ = stamp;
  in_a_row_ = fine == unsynced_ ? in_a_row_ + 1 : 0;
  if (in_a_row_ >= (unsynced_ ? options_.trust_after : options_.distrust_after)) {
    unsynced_ = !unsynced_;
    in_a_row_ = 0;
  }
  if (!fine && !unsynced_) return false;
  const Stamp used = unsynced_ ? now : stamp;
  if (last_stamp_ && used <= *last_stamp_) return false;
  last_stamp_ = used;
  frame.set_stamp(used, unsynced_ ? StampQuality::arrival : frame.info().quality);
  return true;
}

}  // namespace waymark
