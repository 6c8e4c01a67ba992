#include "locd/frames/frame_synchronizer.h"

#include <algorithm>

#include "core/base/check.h"

namespace waymark {

const char* name_of(DropReason reason) {
  constexpr std::array<const char*, kDropReasons> kNames = {"mismatched",  "overtaken", "late",
                                                            "too_few",     "bad_stamp", "unhealthy",
                                                            "solver_busy", "unsearched"};
  return kNames.at(static_cast<std::size_t>(reason));
}

Status SyncOptions::check() const {
  return RangeCheck()
      .field("tolerance in us", in_us(tolerance), kTolerance_us)
      .field("deadline in ms", in_us(deadline) / 1e3, kDeadline_ms)
      .field("min_cameras", min_cameras, kMinCameras)
      .field("leave_after_sets", leave_after_sets, kLeaveAfterSets)
      .status();
}

Stamp FrameSetLease::set_stamp() const {
  for (std::size_t c = 0; c < kMaxCameras; ++c) {
    if (has(c)) return frames[c].stamp();
  }
  return Stamp{0};
}

Stamp FrameSetLease::mean_stamp() const {
  const Stamp base = set_stamp();
  Stamp sum{0};  // of differences: sums of stamps since 1970 would not fit
  int count = 0;
  for (std::size_t c = 0; c < kMaxCameras; ++c) {
    if (!has(c)) continue;
    sum += frames[c].stamp() - base;
    ++count;
  }
  return count == 0 ? base : base + sum / count;
}

Stamp FrameSetLease::max_skew() const {
  Stamp low = Stamp::max();
  Stamp high = Stamp::min();
  for (std::size_t c = 0; c < kMaxCameras; ++c) {
    if (!has(c)) continue;
    low = std::min(low, frames[c].stamp());
    high = std::max(high, frames[c].stamp());
  }
  return cameras == 0 ? Stamp{0} : high - low;
}

FrameSynchronizer::FrameSynchronizer(std::size_t cameras, const SyncOptions& options)
    : cameras_(cameras), options_(options) {
  WAYMARK_CHECK(cameras >= 1 && cameras <= kMaxCameras);
  WAYMARK_CHECK(options.check().has_value());
}

void FrameSynchronizer::drop(Slot& slot, DropReason reason) {
  ++slot.dropped[static_cast<std::size_t>(reason)];
  slot.frame.reset();
}

void FrameSynchronizer::push(std::size_t camera, Frame frame, Stamp now) {
  WAYMARK_CHECK(camera < cameras_);
  Slot& slot = slots_[camera];
  slot.missed_sets = 0;  // it lives: the next sets wait for it
  if (slot.gone_until && frame.stamp() <= *slot.gone_until) {
    ++slot.dropped[static_cast<std::size_t>(DropReason::late)];
    return;
  }
  if (slot.frame) drop(slot, DropReason::overtaken);
  slot.frame.emplace(std::move(frame));
  slot.arrived = now;
}

std::optional<FrameSetLease> FrameSynchronizer::take(Stamp now) {
  while (const auto first = earliest()) {
    const CameraMask together = belonging_to(slots_[*first].frame->stamp());
    const CameraMask awaited = quorum();
    const bool complete = (awaited & ~together) == 0;
    const bool overdue = now >= *next_deadline();
    if (complete || overdue) {
      if (auto set = emit(together)) return set;
    } else if ((awaited & ~held()) == 0) {
      drop(slots_[*first], DropReason::mismatched);
    } else {
      return std::nullopt;
    }
  }
  return std::nullopt;
}

std::optional<FrameSetLease> FrameSynchronizer::emit(CameraMask cameras) {
  FrameSetLease set;
  set.cameras = cameras;
  set.expected = static_cast<CameraMask>((std::uint64_t{1} << cameras_) - 1);
  Stamp first = Stamp::max();
  int count = 0;
  for (std::size_t c = 0; c < cameras_; ++c) {
    Slot& slot = slots_[c];
    if (!set.has(c)) {
      ++slot.missed_sets;
      continue;
    }
    first = std::min(first, slot.frame->stamp());
    slot.gone_until = slot.frame->stamp();
    set.frames[c] = std::move(*slot.frame);
    slot.frame.reset();
    ++count;
  }
  for (std::size_t c = 0; c < cameras_; ++c) {
    if (!set.has(c)) slots_[c].gone_until = first + options_.tolerance;
  }
  if (count < options_.min_cameras) {
    for (std::size_t c = 0; c < cameras_; ++c) {
      if (set.has(c)) drop(slots_[c], DropReason::too_few);
    }
    return std::nullopt;
  }
  set.sequence = sequence_++;
  return set;
}

std::optional<std::size_t> FrameSynchronizer::earliest() const {
  std::optional<std::size_t> first;
  for (std::size_t c = 0; c < cameras_; ++c) {
    if (!slots_[c].frame) continue;
    if (!first || slots_[c].frame->stamp() < slots_[*first].frame->stamp()) first = c;
  }
  return first;
}

CameraMask FrameSynchronizer::belonging_to(Stamp earliest) const {
  CameraMask mask = 0;
  for (std::size_t c = 0; c < cameras_; ++c) {
    if (slots_[c].frame && slots_[c].frame->stamp() - earliest <= options_.tolerance) {
      mask |= camera_bit(c);
    }
  }
  return mask;
}

CameraMask FrameSynchronizer::held() const {
  CameraMask mask = 0;
  for (std::size_t c = 0; c < cameras_; ++c) {
    if (slots_[c].frame) mask |= camera_bit(c);
  }
  return mask;
}

CameraMask FrameSynchronizer::quorum() const {
  CameraMask mask = 0;
  for (std::size_t c = 0; c < cameras_; ++c) {
    const bool left =
        options_.leave_after_sets > 0 && slots_[c].missed_sets >= options_.leave_after_sets;
    if (!left) mask |= camera_bit(c);
  }
  return mask;
}

std::optional<Stamp> FrameSynchronizer::next_deadline() const {
  std::optional<Stamp> arrived;
  for (std::size_t c = 0; c < cameras_; ++c) {
    if (slots_[c].frame && (!arrived || slots_[c].arrived < *arrived)) arrived = slots_[c].arrived;
  }
  if (!arrived) return std::nullopt;
  return *arrived + options_.deadline;
}

}  // namespace waymark
