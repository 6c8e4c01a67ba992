#pragma once

#include "core/marker/family.h"

namespace waymark {

// ArUco's predefined families of one code size begin with one another: aruco_4x4_50 is the first 50
// codes of aruco_4x4_1000.

/// The largest family that begins with this one's codes, maybe itself.
[[nodiscard]] Family largest_beginning_with(Family family);

/// The smallest that begins `largest` and holds this number.
[[nodiscard]] Family smallest_holding(Family largest, int number);

/// Whether the two have codes in common: one begins with the other, or they are the same.
[[nodiscard]] inline bool share_codes(Family a, Family b) {
  return largest_beginning_with(a) == largest_beginning_with(b);
}

}  // namespace waymark
