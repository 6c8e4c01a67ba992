#include "core/detect/side_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/detect/gaussian_step.h"

namespace waymark {
namespace {

/// Order of the unknowns: shift at start and end, ln blur, black at start and end, white likewise
/// and its unevenness, share of the contrast lost beyond the paper's end, outward bow of the
/// middle.
enum Unknown {
  kShift0,
  kShift1,
  kLogBlur,
  kBlack0,
  kBlack1,
  kWhite0,
  kWhite1,
  kUneven0,
  kUneven1,
  kPaperEnd,
  kBow
};
constexpr int kCount = 11;

using Unknowns = Eigen::Matrix<double, kCount, 1>;
using Information = Eigen::Matrix<double, kCount, kCount>;

/// Residuals beyond this many noise levels are mostly shut out, unless a side that is bent by this
/// much (paper is never flat) explains them.
constexpr double kOutlierNoises = 4;
constexpr double kBentPx = 0.5;
/// Rounding to 8 bits and what the model leaves out keep the noise above this (grey levels).
constexpr double kMinNoiseGrey = 0.7;
/// Grey levels from here on say only that there was that much light or more: the sensor's limit,
/// less what its noise and JPEG take off it.
constexpr double kSaturatedGrey = 250;
constexpr double kMinBlurPx = 0.25;
constexpr double kMaxBlurPx = 4;
constexpr double kMaxBandPx = 8;
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
/// no farther than the paper may end, one cell away.
Band usable_band(double border_px, double paper_px, double blur_px) {
  const double wide = std::clamp(2.5 * blur_px + 0.5, 2.0, kMaxBandPx);
  return {std::min(wide, std::max(1.0, border_px)), std::clamp(paper_px, 1.0, wide)};
}

/// What SideAppearance::uneven_grey adds at a place on the side, 0 at both ends.
Eigen::Vector2d unevenness(double place) {
  const double middle = 4 * place * (1 - place);
  return {middle, middle * (1 - 2 * place) / 0.375};
}

/// One pixel's whiteness and its derivatives.
struct Whiteness {
  double value;
  double d_shift;
  double d_log_blur;
  double d_paper_end;
};

Whiteness whiteness_at(double outside_px, const InwardSteps& steps, double paper_end,
                       double blurs_per_px, double open_share) {
  const double z = outside_px * blurs_per_px;
  const GaussianStep outer = gaussian_step(z);
  Whiteness w{outer.value, -outer.slope * blurs_per_px, -outer.slope * z, 0};
  const double z_paper = (outside_px - steps.paper_px) * blurs_per_px;
  if (z_paper > -kStepBlurs) {
    const GaussianStep paper = gaussian_step(z_paper);
    const double lost = steps.paper_end.value_or(paper_end);
    w.value -= lost * paper.value;
    w.d_log_blur += lost * paper.slope * z_paper;
    w.d_paper_end = steps.paper_end ? 0 : -paper.value;
  }
  for (std::size_t i = 0; i < InwardSteps::kRows; ++i) {
    if (steps.change[i] == 0) continue;
    const double z_inner = (-outside_px - steps.depth_px[i]) * blurs_per_px;
    if (z_inner < -kStepBlurs) continue;
    const GaussianStep inner = gaussian_step(z_inner);
    w.value += steps.change[i] * inner.value;
    w.d_log_blur -= steps.change[i] * inner.slope * z_inner;
  }
  return {1 - open_share * (1 - w.value), open_share * w.d_shift, open_share * w.d_log_blur,
          open_share * w.d_paper_end};
}

/// A distance along a line of pixels.
struct Ramp {
  double at_edge = 0;
  double per_px = 0;

  [[nodiscard]] double at(double beyond_edge_px) const { return at_edge + per_px * beyond_edge_px; }
};

/// One line of pixels across the side: all share their place on it, so that they are summed over
/// five local unknowns first: shift, ln blur, black, white (four in a SIMD register) and paper's
/// end.
struct PixelLine {
  double place;
  Ramp outside;  ///< distance from the side
  Ramp before;   ///< from the neighbouring sides
  Ramp after;
  bool near_corner;
  InwardSteps steps;
  double black;
  double white;

  Eigen::Matrix4f information = Eigen::Matrix4f::Zero();
  Eigen::Vector4f paper_information = Eigen::Vector4f::Zero();  // paper's end with the four
  float paper_square = 0;
  Eigen::Vector4f gradient = Eigen::Vector4f::Zero();
  float paper_gradient = 0;
};

/// Accumulates and solves one Gauss–Newton step.
class SideFit {
 public:
  SideFit(const GrayView& image, const SideScene& scene, const SideAppearance& start)
      : image_(image), scene_(scene), start_(start), blurs_per_px_(1 / start.blur_px) {
    noise_grey_ = std::max(start.noise_grey, kMinNoiseGrey);
    const double bent_share = std::min(0.5, 0.4 * kBentPx / start.blur_px);
    outlier_grey_ = std::max(kOutlierNoises * noise_grey_, bent_share * start.contrast_grey());
  }

  /// All usable pixels of image column (or row, for a steep side) `line`.
  void add_line(int axis, int line);
  void add_prior(const SidePrior& prior);
  [[nodiscard]] std::optional<SideStep> solve() const;

 private:
  void add_pixel(PixelLine& line, double beyond_edge_px, double grey);
  void add_sums(const PixelLine& line);

  const GrayView& image_;
  const SideScene& scene_;
  const SideAppearance& start_;
  double blurs_per_px_;
  double noise_grey_;
  double outlier_grey_;
  Information information_ = Information::Zero();  // times noise²; lower triangle
  Unknowns gradient_ = Unknowns::Zero();
  double pixel_information_blur_ = 0;
  double weights_ = 0;
  double weighted_squares_ = 0;
  int pixels_ = 0;
  int paper_pixels_ = 0;
  int saturated_pixels_ = 0;
};

/// Distance from `side` along a line of pixels through `edge` in direction `axis`.
Ramp distance_along(const ImageSide& side, const Eigen::Vector2d& edge, int axis) {
  const double bend_slope = side.bend_slope_px(side.place(edge)) / side.length_px();
  return {side.outside_px(edge), side.outward()[axis] - bend_slope * side.along()[axis]};
}

void SideFit::add_line(int axis, int line) {
  const ImageSide& side = scene_.side;
  double place = (line - side.start_px()[axis]) / (side.along()[axis] * side.length_px());
  for (int i = 0; i < 3; ++i) {  // Newton's method: the chord's place, corrected for the bend
    const double px_per_place =
        side.along()[axis] * side.length_px() + side.outward()[axis] * side.bend_slope_px(place);
    place += (line - side.point_px(place)[axis]) / px_per_place;
  }
  if (!(place >= 0 && place <= 1)) return;
  const Eigen::Vector2d edge = side.point_px(place);
  const int other = 1 - axis;
  PixelLine pixels;
  pixels.place = place;
  pixels.outside = {0, distance_along(side, edge, other).per_px};
  pixels.before = distance_along(scene_.before, edge, other);
  pixels.after = distance_along(scene_.after, edge, other);
  const double slant = std::abs(pixels.outside.per_px);  // distance from the side per pixel
  if (slant < 0.5) return;

  Eigen::Vector2d inward = Eigen::Vector2d::Zero();
  inward[other] = pixels.outside.per_px > 0 ? -1 : 1;
  constexpr double kReachPx = kMaxBandPx + kStepBlurs * kMaxBlurPx;
  // The cells are known between chords: where the sides bend outward, every row is that much wider.
  const double bend_px = side.bend_px(place);
  const double wider_px =
      (bend_px + scene_.opposite.bend_px(1 - place)) / scene_.cells.cells_across();
  pixels.steps = scene_.cells.behind(edge - bend_px * side.outward(), inward, side.along(),
                                     start_.blur_px, kReachPx);
  for (std::size_t i = 0; i < InwardSteps::kRows; ++i) {
    double& depth_px = pixels.steps.depth_px[i];
    depth_px = depth_px * slant + wider_px * static_cast<double>(i + 1);
  }
  pixels.steps.border_px = pixels.steps.border_px * slant + wider_px;
  pixels.steps.paper_px = pixels.steps.paper_px * slant + wider_px;
  if (!(pixels.steps.border_px > 0.5 && pixels.steps.paper_px > 0.5)) return;
  pixels.black = (1 - place) * start_.black_grey[0] + place * start_.black_grey[1];
  pixels.white = (1 - place) * start_.white_grey[0] + place * start_.white_grey[1] +
                 unevenness(place).dot(start_.uneven_grey);

  const Band band = usable_band(pixels.steps.border_px, pixels.steps.paper_px, start_.blur_px);
  const double a = edge[other] + band.outside_px / pixels.outside.per_px;
  const double b = edge[other] - band.inside_px / pixels.outside.per_px;
  const int limit = other == 0 ? image_.width_px : image_.height_px;
  const int first = std::max(0, static_cast<int>(std::ceil(std::min(a, b))));
  const int last = std::min(limit - 1, static_cast<int>(std::floor(std::max(a, b))));
  const double nearest =
      std::max({pixels.before.at(first - edge[other]), pixels.before.at(last - edge[other]),
                pixels.after.at(first - edge[other]), pixels.after.at(last - edge[other])});
  pixels.near_corner = nearest > -kStepBlurs * start_.blur_px;
  for (int across = first; across <= last; ++across) {
    const double grey = axis == 0 ? image_.row(across)[line] : image_.row(line)[across];
    add_pixel(pixels, across - edge[other], grey);
  }
  add_sums(pixels);
}

void SideFit::add_pixel(PixelLine& line, double beyond_edge_px, double grey) {
  double open_share = 1;
  if (line.near_corner) {
    const double before = line.before.at(beyond_edge_px) * blurs_per_px_;
    const double after = line.after.at(beyond_edge_px) * blurs_per_px_;
    if (std::max(before, after) > -kCornerBlurs) return;
    open_share = gaussian_step(-before).value * gaussian_step(-after).value;
  }

  const Whiteness w = whiteness_at(line.outside.at(beyond_edge_px), line.steps, start_.paper_end,
                                   blurs_per_px_, open_share);
  const double contrast = line.white - line.black;
  const double expected = line.black + contrast * w.value;
  const bool saturated = grey >= kSaturatedGrey;
  if (w.value > 0.5) {
    ++paper_pixels_;
    if (saturated) ++saturated_pixels_;
  }
  if (saturated && expected >= kSaturatedGrey) return;  // as it must be, and it tells no more
  const double residual = grey - expected;
  const double outlying = residual / outlier_grey_;
  const double root = 1 / (1 + outlying * outlying);
  const double weight = root * root;
  const Eigen::Vector4f derivative(static_cast<float>(contrast * w.d_shift),
                                   static_cast<float>(contrast * w.d_log_blur),
                                   static_cast<float>(1 - w.value), static_cast<float>(w.value));
  const auto d_paper_end = static_cast<float>(contrast * w.d_paper_end);
  const Eigen::Vector4f weighted = static_cast<float>(weight) * derivative;
  const auto weighted_residual = static_cast<float>(weight * residual);
  line.information += derivative.lazyProduct(weighted.transpose());
  line.paper_information += d_paper_end * weighted;
  line.paper_square += static_cast<float>(weight) * d_paper_end * d_paper_end;
  line.gradient += weighted_residual * derivative;
  line.paper_gradient += weighted_residual * d_paper_end;
  weights_ += weight;
  weighted_squares_ += weight * residual * residual;
  ++pixels_;
}

/// Spreads a line's sums over the side's unknowns: each is one of the local ones times a function
/// of the place.
void SideFit::add_sums(const PixelLine& line) {
  Eigen::Matrix<double, 5, 5> information;
  information.topLeftCorner<4, 4>() = line.information.cast<double>();
  information.topRightCorner<4, 1>() = line.paper_information.cast<double>();
  information.bottomLeftCorner<1, 4>() = line.paper_information.cast<double>();
  information(4, 4) = line.paper_square;
  const std::array<double, 5> gradient{line.gradient[0], line.gradient[1], line.gradient[2],
                                       line.gradient[3], line.paper_gradient};
  const double s = line.place;
  constexpr std::array<int, kCount> kLocal{0, 0, 1, 2, 2, 3, 3, 3, 3, 4, 0};
  const Eigen::Vector2d uneven = unevenness(s);
  const std::array<double, kCount> factor{1 - s,     s,         1, 1 - s,          s, 1 - s, s,
                                          uneven[0], uneven[1], 1, 4 * s * (1 - s)};
  for (std::size_t u = 0; u < kCount; ++u) {
    const auto i = static_cast<Eigen::Index>(u);
    gradient_[i] += factor[u] * gradient[static_cast<std::size_t>(kLocal[u])];
    for (std::size_t v = 0; v <= u; ++v) {
      information_(i, static_cast<Eigen::Index>(v)) +=
          factor[u] * factor[v] * information(kLocal[u], kLocal[v]);
    }
  }
  pixel_information_blur_ += information(1, 1);
}

void SideFit::add_prior(const SidePrior& prior) {
  const auto add = [&](Unknown unknown, double difference, double sigma) {
    const double weight = noise_grey_ * noise_grey_ / (sigma * sigma);
    information_(unknown, unknown) += weight;
    gradient_[unknown] += weight * difference;
  };
  const SideAppearance& mean = prior.mean;
  add(kLogBlur, std::log(mean.blur_px / start_.blur_px), prior.log_blur_sigma);
  add(kBlack0, mean.black_grey[0] - start_.black_grey[0], prior.black_sigma);
  add(kBlack1, mean.black_grey[1] - start_.black_grey[1], prior.black_sigma);
  add(kWhite0, mean.white_grey[0] - start_.white_grey[0], prior.white_sigma);
  add(kWhite1, mean.white_grey[1] - start_.white_grey[1], prior.white_sigma);
  add(kUneven0, -start_.uneven_grey[0], prior.uneven_sigma);
  add(kUneven1, -start_.uneven_grey[1], prior.uneven_sigma);
  constexpr double kPaperEndSigma = 0.5;
  add(kPaperEnd, -start_.paper_end, kPaperEndSigma);
  // Sides are straight but for paper and lenses that aren't: Cauchy's prior lets go of a bow that
  // the pixels insist on.
  constexpr double kStraightPx = 0.02;
  add(kBow, -start_.bow_px, std::hypot(kStraightPx, start_.bow_px) / std::sqrt(2.0));
}

std::optional<SideStep> SideFit::solve() const {
  if (pixels_ < kMinSidePixels || weights_ < 0.5 * kMinSidePixels) return std::nullopt;
  const Eigen::LDLT<Information> factor(information_);
  if (factor.info() != Eigen::Success || !factor.isPositive()) return std::nullopt;
  const Unknowns step = factor.solve(gradient_);
  if (!step.allFinite()) return std::nullopt;

  SideStep result;
  result.shift_px = step.head<2>();
  constexpr double kMaxLogBlurStep = 0.5;
  result.appearance.blur_px = std::clamp(
      start_.blur_px * std::exp(std::clamp(step[kLogBlur], -kMaxLogBlurStep, kMaxLogBlurStep)),
      kMinBlurPx, kMaxBlurPx);
  result.appearance.black_grey = start_.black_grey + step.segment<2>(kBlack0);
  result.appearance.white_grey = start_.white_grey + step.segment<2>(kWhite0);
  result.appearance.uneven_grey = start_.uneven_grey + step.segment<2>(kUneven0);
  result.appearance.paper_end = start_.paper_end + step[kPaperEnd];
  constexpr double kMaxBowStepPx = 1;
  result.appearance.bow_px = start_.bow_px + std::clamp(step[kBow], -kMaxBowStepPx, kMaxBowStepPx);
  const double freedom = std::max(1.0, weights_ - kCount);
  result.appearance.noise_grey = std::max(kMinNoiseGrey, std::sqrt(weighted_squares_ / freedom));
  const double variance = result.appearance.noise_grey * result.appearance.noise_grey;
  Eigen::Matrix<double, kCount, 2> shift_axes = Eigen::Matrix<double, kCount, 2>::Zero();
  shift_axes.topRows<2>().setIdentity();
  result.covariance = variance * factor.solve(shift_axes).topRows<2>();
  result.information_blur = pixel_information_blur_ / variance;
  result.pixels = pixels_;
  result.outlier_share = 1 - weights_ / pixels_;
  result.saturated_share = std::min(1.0, saturated_pixels_ / std::max(1.0, 1.0 * paper_pixels_));
  return result;
}

}  // namespace

std::optional<SideStep> fit_side(const GrayView& image, const SideScene& scene,
                                 const SideAppearance& start, const SidePrior& prior,
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
  fit.add_prior(prior);
  return fit.solve();
}

}  // namespace waymark
