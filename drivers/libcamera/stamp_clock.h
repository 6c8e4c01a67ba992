#pragma once

#include "core/geometry/stamp.h"

namespace waymark {

/// A driver's stamp on CLOCK_MONOTONIC, whether it counts by that clock or by CLOCK_BOOTTIME, which
/// also counts suspended time: libcamera's documentation states the latter, most of its drivers
/// give the former. What lies after now by more than `slack` can only be of the clock that is
/// ahead.
[[nodiscard]] inline Stamp to_monotonic(Stamp stamp, Stamp monotonic_now, Stamp boottime_now,
                                        Stamp slack = std::chrono::milliseconds(2)) {
  const bool of_boottime = stamp > monotonic_now + slack;
  return of_boottime ? stamp - (boottime_now - monotonic_now) : stamp;
}

}  // namespace waymark
