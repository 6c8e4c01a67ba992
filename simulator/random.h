#pragma once

#include <cstdint>
#include <initializer_list>

namespace waymark::simulator {

/// Small counter-free generator (splitmix64): the same numbers on every machine and with every
/// standard library, which std::normal_distribution does not promise.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  /// A stream of its own for each tuple (seed, camera, position, …): results do not depend on the
  /// order of work.
  [[nodiscard]] static Random of(std::initializer_list<std::uint64_t> key);

  [[nodiscard]] std::uint64_t bits() {
    state_ += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31U);
  }

  /// Uniform in [0, 1).
  [[nodiscard]] double uniform() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }
  [[nodiscard]] double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Uniform integer in [0, count), count > 0.
  [[nodiscard]] std::uint64_t below(std::uint64_t count) { return bits() % count; }

  /// Standard normal (Box–Muller).
  [[nodiscard]] double normal();

 private:
  std::uint64_t state_;
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace waymark::simulator
