#pragma once

#include <chrono>
#include <cmath>

namespace waymark {

/// Mid-exposure time of a frame, in ns since any epoch; one clock for all cameras of a capture.
using Stamp = std::chrono::nanoseconds;

/// A time given in µs, to the nearest ns.
[[nodiscard]] inline Stamp from_us(double us) {
  return Stamp(static_cast<Stamp::rep>(std::llround(us * 1e3)));
}

}  // namespace waymark
