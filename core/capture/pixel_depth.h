#pragma once

#include <initializer_list>

namespace waymark {

/// How many bits are in use where values have 16: cameras of 10, 12 and 14 bits write them at
/// either end, and which, only the largest value of an image tells. 10, 12, 14 or 16: the fewest
/// that hold it.
[[nodiscard]] constexpr int bits_in_use(int largest) {
  for (const int bits : {10, 12, 14}) {
    if (largest < 1 << bits) return bits;
  }
  return 16;
}

}  // namespace waymark
