#include "core/detect/common_blur.h"

#include <algorithm>
#include <cmath>

#include "core/base/median.h"

namespace waymark {
namespace {

constexpr std::size_t kFewestSides = 12;

}  // namespace

void CommonBlur::add(const RefinedCorners& marker) {
  if (marker.saturated_share >= kSaturatedPaper) return;
  for (const SideBlur& side : marker.side_blurs) {
    if (side.information > 0) sides_.push_back(side);
  }
}

std::optional<BlurPrior> CommonBlur::prior() {
  if (sides_.size() < kFewestSides) return std::nullopt;
  const auto median_of = [&](const auto& value) {
    scratch_.clear();
    for (const SideBlur& side : sides_) scratch_.push_back(value(side));
    return upper_median(scratch_);
  };
  const double middle = median_of([](const SideBlur& s) { return s.log_px; });
  const double spread =
      1.4826 * median_of([&](const SideBlur& s) { return std::abs(s.log_px - middle); });
  const double fit_variance = median_of([](const SideBlur& s) { return 1 / s.information; });
  // What a Gaussian point spread leaves out of a real one differs between black and grey surrounds.
  constexpr double kModelSigma = 0.02;
  const double true_variance = std::max(0.0, spread * spread - fit_variance);
  const double median_variance = 1.57 * spread * spread / static_cast<double>(sides_.size());
  return BlurPrior{middle, std::sqrt(true_variance + median_variance + kModelSigma * kModelSigma)};
}

}  // namespace waymark
