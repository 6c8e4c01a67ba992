#pragma once

#include <array>
#include <cmath>
#include <optional>

namespace waymark {

/// A unit in which lengths may have been written that are to be in metres.
struct LengthUnit {
  const char* name;
  double per_metre;
};

inline constexpr std::array<LengthUnit, 4> kLengthUnits{
    {{"mm", 1000}, {"cm", 100}, {"inches", 39.3701}, {"feet", 3.28084}}};

/// The unit of lengths that are so many times too long; nullopt for none within 4 %: sizes that
/// they are compared with are right within some percent.
[[nodiscard]] inline std::optional<LengthUnit> unit_of(double times_too_long) {
  constexpr double kSameUnit = 0.04;
  for (const LengthUnit& unit : kLengthUnits) {
    if (std::abs(times_too_long / unit.per_metre - 1.0) < kSameUnit) return unit;
  }
  return std::nullopt;
}

}  // namespace waymark
