#pragma once

#include <algorithm>

#include "core/geometry/stamp.h"

namespace waymark {

/// The pauses between attempts at something: 0.1 s, then twice as long each time, 5 s at most.
class BackOff {
 public:
  [[nodiscard]] Stamp next() {
    const Stamp pause = pause_;
    pause_ = std::min(2 * pause_, kLongest);
    return pause;
  }
  void begin_anew() { pause_ = kFirst; }

  static constexpr Stamp kFirst = std::chrono::milliseconds(100);
  static constexpr Stamp kLongest = std::chrono::seconds(5);

 private:
  Stamp pause_ = kFirst;
};

}  // namespace waymark
