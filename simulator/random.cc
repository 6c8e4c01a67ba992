#include "simulator/random.h"

#include <cmath>
#include <numbers>

namespace waymark::simulator {

Random Random::of(std::initializer_list<std::uint64_t> key) {
  std::uint64_t mixed = 0x5851F42D4C957F2DULL;
  for (const std::uint64_t part : key) mixed = Random(mixed ^ part).bits();
  return Random(mixed);
}

double Random::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  const double angle = 2.0 * std::numbers::pi * uniform();
  spare_ = radius * std::sin(angle);
  has_spare_ = true;
  return radius * std::cos(angle);
}

}  // namespace waymark::simulator
