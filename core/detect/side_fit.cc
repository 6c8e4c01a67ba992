#include "core/detect/side_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/detect/gaussian_step.h"

namespace waymark {
namespace {

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

/// Order of the unknowns: shift at start and end, ln blur, black at start and end, white likewise.
enum Unknown { kShift0, kShift1, kLogBlur, kBlack0, kBlack1, kWhite0, kWhite1 };

/// Residuals beyond this many noise levels are mostly shut out.
constexpr double kOutlierNoises = 4;
/// Rounding to 8 bits and what the model leaves out keep the noise above this (grey levels).
constexpr double kMinNoiseGrey = 0.7;
constexpr double kMinBlurPx = 0.4;
constexpr double kMaxBlurPx = 4;
/// Pixels whose centre is nearer to a neighbouring side than this many blurs are left out.
constexpr double kCornerBlurs = 1.5;
/// Farther than this from an edge, its step is complete.
constexpr double kStepBlurs = 3.5;

/// How far from the side (px) pixels are used.
struct Band {
  double inside_px;
  double outside_px;
};

/// Wide enough to see both plateaus, but inside no farther than the code's cells begin and outside
/// clear of the paper's end, which may be one cell away.
Band usable_band(double border_px, double blur_px) {
  const double wide = std::clamp(2.5 * blur_px + 0.5, 2.0, 8.0);
  const double to_paper_end = border_px - 1.5 * blur_px;
  return {std::min(wide, std::max(1.0, border_px)), std::clamp(to_paper_end, 1.0, wide)};
}

/// One pixel's whiteness and its derivatives.
struct Whiteness {
  double value;
  double d_shift;
  double d_log_blur;
};

Whiteness whiteness_at(double outside_px, const InwardSteps& steps, double blur_px,
                       double open_share) {
  const double z = outside_px / blur_px;
  const GaussianStep outer = gaussian_step(z);
  Whiteness w{outer.value, -outer.slope / blur_px, -outer.slope * z};
  for (std::size_t i = 0; i < InwardSteps::kRows; ++i) {
    if (steps.change[i] == 0) continue;
    const double z_inner = (-outside_px - steps.depth_px[i]) / blur_px;
    if (z_inner < -kStepBlurs) continue;
    const GaussianStep inner = gaussian_step(z_inner);
    w.value += steps.change[i] * inner.value;
    w.d_log_blur -= steps.change[i] * inner.slope * z_inner;
  }
  return {1 - open_share * (1 - w.value), open_share * w.d_shift, open_share * w.d_log_blur};
}

/// Accumulates and solves one Gauss–Newton step.
class SideFit {
 public:
  SideFit(const GrayView& image, const SideScene& scene, const SideAppearance& start)
      : image_(image), scene_(scene), start_(start) {
    noise_grey_ = std::max(start.noise_grey, kMinNoiseGrey);
  }

  /// All usable pixels of image column (or row, for a steep side) `line`.
  void add_line(int axis, int line);
  void add_prior(const SidePrior& prior);
  [[nodiscard]] std::optional<SideStep> solve() const;

 private:
  void add_pixel(int x, int y, const InwardSteps& steps);

  const GrayView& image_;
  const SideScene& scene_;
  const SideAppearance& start_;
  double noise_grey_;
  Matrix7d information_ = Matrix7d::Zero();  // times noise²; upper triangle
  Vector7d gradient_ = Vector7d::Zero();
  double pixel_information_blur_ = 0;
  double weights_ = 0;
  double weighted_squares_ = 0;
  int pixels_ = 0;
};

void SideFit::add_line(int axis, int line) {
  const ImageSide& side = scene_.side;
  double place = 0;
  for (int i = 0; i < 2; ++i) {
    const double step = line - side.point_px(place)[axis];
    place += step / (side.along()[axis] * side.length_px());
  }
  if (place < 0 || place > 1) return;
  const Eigen::Vector2d edge = side.point_px(place);
  const int other = 1 - axis;
  const double outward = side.outward()[other];
  Eigen::Vector2d inward = Eigen::Vector2d::Zero();
  inward[other] = outward > 0 ? -1 : 1;
  InwardSteps steps = scene_.cells.behind(edge, inward, side.along(), start_.blur_px);
  for (double& depth : steps.depth_px) depth *= std::abs(outward);
  const double border_px = steps.border_px * std::abs(outward);
  if (!(border_px > 0.5)) return;

  const Band band = usable_band(border_px, start_.blur_px);
  const double a = edge[other] + band.outside_px / outward;
  const double b = edge[other] - band.inside_px / outward;
  const int limit = other == 0 ? image_.width_px : image_.height_px;
  const int first = std::max(0, static_cast<int>(std::ceil(std::min(a, b))));
  const int last = std::min(limit - 1, static_cast<int>(std::floor(std::max(a, b))));
  for (int across = first; across <= last; ++across) {
    axis == 0 ? add_pixel(line, across, steps) : add_pixel(across, line, steps);
  }
}

void SideFit::add_pixel(int x, int y, const InwardSteps& steps) {
  const Eigen::Vector2d pixel(x, y);
  const double blur = start_.blur_px;
  const double before = scene_.before.outside_px(pixel);
  const double after = scene_.after.outside_px(pixel);
  if (std::max(before, after) > -kCornerBlurs * blur) return;
  double open_share = 1;
  if (before > -kStepBlurs * blur) open_share *= gaussian_step(-before / blur).value;
  if (after > -kStepBlurs * blur) open_share *= gaussian_step(-after / blur).value;

  const double s = scene_.side.place(pixel);
  const Whiteness w = whiteness_at(scene_.side.outside_px(pixel), steps, blur, open_share);
  const double black = (1 - s) * start_.black_grey[0] + s * start_.black_grey[1];
  const double white = (1 - s) * start_.white_grey[0] + s * start_.white_grey[1];
  const double contrast = white - black;
  const double residual = image_.row(y)[x] - (black + contrast * w.value);

  Vector7d derivative;
  derivative << contrast * w.d_shift * (1 - s), contrast * w.d_shift * s, contrast * w.d_log_blur,
      (1 - s) * (1 - w.value), s * (1 - w.value), (1 - s) * w.value, s * w.value;
  const double outlying = residual / (kOutlierNoises * noise_grey_);
  const double root = 1 / (1 + outlying * outlying);
  const double weight = root * root;
  for (int i = 0; i < 7; ++i) {
    const double weighted = weight * derivative[i];
    gradient_[i] += weighted * residual;
    for (int j = i; j < 7; ++j) information_(i, j) += weighted * derivative[j];
  }
  weights_ += weight;
  weighted_squares_ += weight * residual * residual;
  ++pixels_;
  pixel_information_blur_ += weight * derivative[kLogBlur] * derivative[kLogBlur];
}

void SideFit::add_prior(const SidePrior& prior) {
  const auto add = [&](Unknown unknown, double difference, double sigma) {
    const double weight = noise_grey_ * noise_grey_ / (sigma * sigma);
    information_(unknown, unknown) += weight;
    gradient_[unknown] += weight * difference;
  };
  const SideAppearance& mean = prior.mean;
  add(kLogBlur, std::log(mean.blur_px / start_.blur_px), prior.log_blur_sigma);
  add(kBlack0, mean.black_grey[0] - start_.black_grey[0], prior.grey_sigma);
  add(kBlack1, mean.black_grey[1] - start_.black_grey[1], prior.grey_sigma);
  add(kWhite0, mean.white_grey[0] - start_.white_grey[0], prior.grey_sigma);
  add(kWhite1, mean.white_grey[1] - start_.white_grey[1], prior.grey_sigma);
}

std::optional<SideStep> SideFit::solve() const {
  if (pixels_ < kMinSidePixels || weights_ < 0.5 * kMinSidePixels) return std::nullopt;
  const Matrix7d full = information_.selfadjointView<Eigen::Upper>();
  const Eigen::LDLT<Matrix7d> factor(full);
  if (factor.info() != Eigen::Success || !factor.isPositive()) return std::nullopt;
  const Vector7d step = factor.solve(gradient_);
  if (!step.allFinite()) return std::nullopt;

  SideStep result;
  result.shift_px = step.head<2>();
  constexpr double kMaxLogBlurStep = 0.3;
  result.appearance.blur_px = std::clamp(
      start_.blur_px * std::exp(std::clamp(step[kLogBlur], -kMaxLogBlurStep, kMaxLogBlurStep)),
      kMinBlurPx, kMaxBlurPx);
  result.appearance.black_grey = start_.black_grey + step.segment<2>(kBlack0);
  result.appearance.white_grey = start_.white_grey + step.segment<2>(kWhite0);
  const double freedom = std::max(1.0, weights_ - 7);
  result.appearance.noise_grey = std::max(kMinNoiseGrey, std::sqrt(weighted_squares_ / freedom));
  const double variance = result.appearance.noise_grey * result.appearance.noise_grey;
  Eigen::Matrix<double, 7, 2> shift_axes = Eigen::Matrix<double, 7, 2>::Zero();
  shift_axes.topRows<2>().setIdentity();
  result.covariance = variance * factor.solve(shift_axes).topRows<2>();
  result.information_blur = pixel_information_blur_ / variance;
  result.pixels = pixels_;
  result.outlier_share = 1 - weights_ / pixels_;
  return result;
}

}  // namespace

std::optional<SideStep> fit_side(const GrayView& image, const SideScene& scene,
                                 const SideAppearance& start, const SidePrior* prior,
                                 int max_columns) {
  SideFit fit(image, scene, start);
  const Eigen::Vector2d a = scene.side.start_px();
  const Eigen::Vector2d b = scene.side.end_px();
  const int axis = std::abs(b.x() - a.x()) >= std::abs(b.y() - a.y()) ? 0 : 1;
  const int limit = axis == 0 ? image.width_px : image.height_px;
  const int first = std::max(0, static_cast<int>(std::ceil(std::min(a[axis], b[axis]))));
  const int last = std::min(limit - 1, static_cast<int>(std::floor(std::max(a[axis], b[axis]))));
  const int lines = last - first + 1;
  const int used = std::min(lines, max_columns);
  for (int i = 0; i < used; ++i) fit.add_line(axis, first + i * lines / used);
  if (prior != nullptr) fit.add_prior(*prior);
  return fit.solve();
}

}  // namespace waymark
