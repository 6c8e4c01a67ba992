#pragma once

#include <numbers>

namespace waymark {

inline constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

}  // namespace waymark
