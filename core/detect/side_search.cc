#include "core/detect/side_search.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/symmetric_factor.h"

namespace waymark {
namespace {

constexpr int kProfiles = 16;
/// A step (grey levels over 2 px) below this is no edge but noise.
constexpr double kMinStepGrey = 8;
/// Profiles whose step lies within this (px) of a side agree with it: large markers are often the
/// blurred ones, so the bounds grow with the side's length.
constexpr double kMinAgreementPx = 0.75;
constexpr double kAgreement = 0.006;
constexpr double kMaxAgreementPx = 2;
/// A side may bend by this share of its length (a lens whose distortion the model lacks) ...
constexpr double kMaxBend = 0.01;
/// ... but no farther (px).
constexpr double kMaxBendPx = 4;

/// Where one profile across the side has its steepest step.
struct Step {
  double place;
  double outside_px;
  double black_grey;
  double white_grey;
  double rise_grey;  ///< over 2 px
};

std::optional<double> interpolated_grey(const GrayView& image, const Eigen::Vector2d& pixel) {
  const double x = std::floor(pixel.x());
  const double y = std::floor(pixel.y());
  if (!(x >= 0 && y >= 0 && x + 1 < image.width_px && y + 1 < image.height_px)) return std::nullopt;
  const double dx = pixel.x() - x;
  const double dy = pixel.y() - y;
  const std::uint8_t* upper = image.row(static_cast<int>(y)) + static_cast<int>(x);
  const std::uint8_t* lower = upper + image.stride_bytes;
  return (1 - dy) * ((1 - dx) * upper[0] + dx * upper[1]) +
         dy * ((1 - dx) * lower[0] + dx * lower[1]);
}

/// The steepest rise from inside to outside along a profile sampled once per pixel, as far as the
/// image reaches.
std::optional<Step> steepest_step(const GrayView& image, const ImageSide& side, double place,
                                  double reach_px) {
  constexpr int kMaxHalf = 16;
  const int half = std::clamp(static_cast<int>(std::ceil(reach_px)) + 1, 2, kMaxHalf);
  std::array<double, 2 * kMaxHalf + 1> greys{};
  const auto grey = [&](int i) -> double& {
    const int index = i + half;
    return greys[static_cast<std::size_t>(index)];
  };
  const Eigen::Vector2d middle = side.point_px(place);
  int first = 0;
  int last = -1;
  for (int i = -half; i <= half; ++i) {
    const auto sample = interpolated_grey(image, middle + i * side.outward());
    if (!sample) continue;
    if (last < first) first = i;
    last = i;
    grey(i) = *sample;
  }
  if (last - first < 4) return std::nullopt;
  const auto rise = [&](int i) { return grey(i + 1) - grey(i - 1); };
  int best = first + 1;
  for (int i = first + 1; i < last; ++i) {
    if (rise(i) > rise(best)) best = i;
  }
  if (rise(best) < kMinStepGrey) return std::nullopt;
  double fraction = 0;  // vertex of the parabola through the rise and its neighbours
  if (best > first + 1 && best < last - 1) {
    const double before = rise(best - 1);
    const double after = rise(best + 1);
    const double curvature = 2 * rise(best) - before - after;
    if (curvature > 0) fraction = std::clamp(0.5 * (after - before) / curvature, -0.5, 0.5);
  }
  const int plateau = std::clamp(static_cast<int>(0.4 * reach_px), 2, 4);
  return Step{place, best + fraction, grey(std::max(best - plateau, first)),
              grey(std::min(best + plateau, last)), rise(best)};
}

/// outside_px as a function of the place.
struct Curve {
  double start = 0;
  double end = 0;
  double bow = 0;  ///< farther out in the middle

  [[nodiscard]] double at(double place) const {
    return start + (end - start) * place + 4 * bow * place * (1 - place);
  }
};

/// Profiles of one side that have a step.
class Steps {
 public:
  void add(const Step& step) { steps_[count_++] = step; }
  [[nodiscard]] std::size_t count() const { return count_; }

  template <typename Visit>
  void for_agreeing(const Curve& curve, double tolerance_px, const Visit& visit) const {
    for (std::size_t i = 0; i < count_; ++i) {
      if (std::abs(steps_[i].outside_px - curve.at(steps_[i].place)) <= tolerance_px) {
        visit(steps_[i]);
      }
    }
  }

  [[nodiscard]] std::size_t count_agreeing(const Curve& curve, double tolerance_px) const {
    std::size_t agreeing = 0;
    for_agreeing(curve, tolerance_px, [&](const Step&) { ++agreeing; });
    return agreeing;
  }

  [[nodiscard]] Curve line_of_most(double tolerance_px) const;
  [[nodiscard]] Curve fit_to_agreeing(const Curve& curve, double tolerance_px, bool bowed) const;

 private:
  std::array<Step, kProfiles> steps_;
  std::size_t count_ = 0;
};

/// The line through two steps that most steps agree with; of equal ones the first.
Curve Steps::line_of_most(double tolerance_px) const {
  Curve best;
  std::size_t best_agreeing = 0;
  for (std::size_t i = 0; i + 1 < count_; ++i) {
    for (std::size_t j = i + 1; j < count_; ++j) {
      const double slope =
          (steps_[j].outside_px - steps_[i].outside_px) / (steps_[j].place - steps_[i].place);
      const double start = steps_[i].outside_px - slope * steps_[i].place;
      const Curve line{start, start + slope, 0};
      const std::size_t agreeing = count_agreeing(line, tolerance_px);
      if (agreeing > best_agreeing) {
        best_agreeing = agreeing;
        best = line;
      }
    }
  }
  return best;
}

/// Least squares through the steps that agree with `curve`.
Curve Steps::fit_to_agreeing(const Curve& curve, double tolerance_px, bool bowed) const {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for_agreeing(curve, tolerance_px, [&](const Step& step) {
    const double s = step.place;
    const Eigen::Vector3d basis(1 - s, s, bowed ? 4 * s * (1 - s) : 0);
    information += basis * basis.transpose();
    right += step.outside_px * basis;
  });
  if (!bowed) information(2, 2) = 1;
  const Eigen::Vector3d solution = SymmetricFactor<3>(information).solve(right);
  return solution.allFinite() ? Curve{solution[0], solution[1], solution[2]} : curve;
}

}  // namespace

std::optional<FoundSide> search_side(const GrayView& image, const ImageSide& side,
                                     double reach_px) {
  Steps steps;
  const double margin = std::clamp(2.0 / side.length_px(), 0.08, 0.3);
  for (int i = 0; i < kProfiles; ++i) {
    const double place = margin + (1 - 2 * margin) * i / (kProfiles - 1);
    if (const auto step = steepest_step(image, side, place, reach_px)) steps.add(*step);
  }
  constexpr std::size_t kMinAgreeing = kProfiles / 2;
  if (steps.count() < kMinAgreeing) return std::nullopt;
  const double length_px = side.length_px();
  const double agreement_px = std::clamp(kAgreement * length_px, kMinAgreementPx, kMaxAgreementPx);
  const double bend_px = std::clamp(kMaxBend * length_px, kMinAgreementPx, kMaxBendPx);
  Curve curve = steps.line_of_most(bend_px);
  curve = steps.fit_to_agreeing(curve, bend_px, bend_px > agreement_px);
  if (steps.count_agreeing(curve, agreement_px) < kMinAgreeing) return std::nullopt;

  FoundSide found;
  found.shift_px = {curve.start, curve.end};
  found.bow_px = curve.bow;
  double agreeing = 0;
  double rise_grey = 0;
  steps.for_agreeing(curve, agreement_px, [&](const Step& step) {
    agreeing += 1;
    found.black_grey += step.black_grey;
    found.white_grey += step.white_grey;
    rise_grey += step.rise_grey;
  });
  found.black_grey /= agreeing;
  found.white_grey /= agreeing;
  // The steepest rise over 2 px of a Gaussian step is contrast · 2 px / (√(2π) σ).
  found.blur_px =
      std::clamp(0.8 * (found.white_grey - found.black_grey) * agreeing / rise_grey, 0.6, 3.5);
  return found;
}

}  // namespace waymark
