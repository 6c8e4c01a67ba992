#include "core/detect/gaussian_step.h"

#include <cmath>
#include <numbers>

namespace waymark {

GaussianTable::GaussianTable() {
  for (std::size_t i = 0; i < kCount; ++i) {
    const double x = static_cast<double>(i) / kPerUnit - kReach;
    steps[i] = {0.5 * std::erfc(-x / std::numbers::sqrt2),
                std::exp(-0.5 * x * x) / std::sqrt(2 * std::numbers::pi)};
  }
}

const GaussianTable kGaussianTable;

}  // namespace waymark
