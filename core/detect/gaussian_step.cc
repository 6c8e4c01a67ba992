#include "core/detect/gaussian_step.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace waymark {
namespace {

constexpr double kReach = 5;
constexpr int kPerUnit = 128;
constexpr int kIntervals = static_cast<int>(2 * kReach) * kPerUnit;

std::array<GaussianStep, kIntervals + 1> make_table() {
  std::array<GaussianStep, kIntervals + 1> table;
  for (int i = 0; i <= kIntervals; ++i) {
    const double x = static_cast<double>(i) / kPerUnit - kReach;
    table[static_cast<std::size_t>(i)] = {0.5 * std::erfc(-x / std::numbers::sqrt2),
                                          std::exp(-0.5 * x * x) / std::sqrt(2 * std::numbers::pi)};
  }
  return table;
}

const std::array<GaussianStep, kIntervals + 1> kTable = make_table();

}  // namespace

GaussianStep gaussian_step(double x) {
  if (!(x > -kReach)) return {0, 0};
  if (x >= kReach) return {1, 0};
  const double place = (x + kReach) * kPerUnit;
  const auto i = static_cast<std::size_t>(place);
  const double t = place - static_cast<double>(i);
  const GaussianStep& a = kTable[i];
  const GaussianStep& b = kTable[i + 1];
  return {a.value + t * (b.value - a.value), a.slope + t * (b.slope - a.slope)};
}

}  // namespace waymark
