#pragma once

#include <chrono>

#include "core/geometry/stamp.h"

namespace waymark {

/// Now on CLOCK_MONOTONIC, the clock of every stamp in locd.
[[nodiscard]] inline Stamp monotonic_now() {
  return std::chrono::duration_cast<Stamp>(std::chrono::steady_clock::now().time_since_epoch());
}

/// A stamp as a time point to wait for.
[[nodiscard]] inline std::chrono::steady_clock::time_point as_time_point(Stamp stamp) {
  return std::chrono::steady_clock::time_point(
      std::chrono::duration_cast<std::chrono::steady_clock::duration>(stamp));
}

}  // namespace waymark
