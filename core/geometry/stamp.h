#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>

namespace waymark {

/// Mid-exposure time of a frame, in ns since any epoch; one clock for all cameras of a capture.
using Stamp = std::chrono::nanoseconds;

/// Stamps from outside lie within ± 146 years of their epoch; what lies beyond is no time, and sums
/// and differences of two stamps would not fit.
inline constexpr Stamp kLargestStamp{(std::int64_t{1} << 62) - 1};

[[nodiscard]] constexpr bool is_in_range(Stamp stamp) {
  return -kLargestStamp <= stamp && stamp <= kLargestStamp;
}

/// later − earlier; where that does not fit, the longest time there is, of the same sign.
[[nodiscard]] constexpr Stamp time_between(Stamp earlier, Stamp later) {
  Stamp::rep difference = 0;
  if (!__builtin_sub_overflow(later.count(), earlier.count(), &difference)) {
    return Stamp(difference);
  }
  return later > earlier ? Stamp::max() : Stamp::min();
}

/// A time given in µs, to the nearest ns.
[[nodiscard]] inline Stamp from_us(double us) {
  return Stamp(static_cast<Stamp::rep>(std::llround(us * 1e3)));
}

/// A time in µs.
[[nodiscard]] constexpr double in_us(Stamp time) { return static_cast<double>(time.count()) / 1e3; }

/// A time in s.
[[nodiscard]] constexpr double in_s(Stamp time) { return static_cast<double>(time.count()) / 1e9; }

}  // namespace waymark
