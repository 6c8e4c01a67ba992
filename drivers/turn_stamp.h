#pragma once

#include <atomic>

#include "core/geometry/stamp.h"

namespace waymark {

/// When a thread last went on, for a watchdog in another.
class TurnStamp {
 public:
  void touch(Stamp now) { since_ns_.store(now.count(), std::memory_order_relaxed); }
  [[nodiscard]] Stamp last() const { return Stamp(since_ns_.load(std::memory_order_relaxed)); }

 private:
  std::atomic<Stamp::rep> since_ns_{0};
};

}  // namespace waymark
