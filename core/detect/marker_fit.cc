#include "core/detect/marker_fit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/median.h"
#include "core/detect/marker_pixels.h"
#include "core/geometry/levenberg_marquardt.h"
#include "core/marker/marker_outline.h"

namespace waymark {
namespace {

/// Numbers of a fit: the shape, then of light three of black and six of contrast.
constexpr int kNumbers = 21;
constexpr int kShapeNumbers = MarkerShape::SizeAtCompileTime;
constexpr int kBlackLevels = 3;
constexpr int kContrastLevels = 6;
constexpr int kLevels = kBlackLevels + kContrastLevels;
using Numbers = Eigen::Matrix<double, kNumbers, 1>;
using Levels = Eigen::Matrix<double, kLevels, 1>;

constexpr std::size_t kFewestPixels = 100;
/// Grey values at which a pixel may be clipped, 0 black, 1 white.
constexpr double kWhiteEnd = 252.5 / 255;
constexpr double kBlackEnd = 1.5 / 255;
/// No image is steadier.
constexpr double kLeastScale = 0.3 / 255;
/// Geman and McClure's bound, in sigmas.
constexpr double kBound = 6.0;

bool is_clipped(double grey) { return grey >= kWhiteEnd || grey <= kBlackEnd; }

bool sees_an_edge(double white) { return white > 0.04 && white < 0.96; }

/// A pixel's light under some levels.
double light_of(const MarkerPixel& pixel, double white, const Levels& levels) {
  return pixel.place.head<kBlackLevels>().dot(levels.head<kBlackLevels>()) +
         pixel.place.dot(levels.tail<kContrastLevels>()) * white;
}

/// Grey seen less grey expected; nothing where both are clipped.
double residual_of(const MarkerPixel& pixel, double expected) {
  const bool both = (pixel.grey >= kWhiteEnd && expected >= kWhiteEnd) ||
                    (pixel.grey <= kBlackEnd && expected <= kBlackEnd);
  return both ? 0.0 : pixel.grey - expected;
}

/// Noise, of pixels that see an edge and of the others: what is wrong with a lens or a print shows
/// at edges alone.
struct Scales {
  double edges = kLeastScale;
  double rest = kLeastScale;

  [[nodiscard]] double at(double white) const { return sees_an_edge(white) ? edges : rest; }
};

double scale_of(std::vector<double>& residuals) {
  if (residuals.empty()) return kLeastScale;
  const double middle = upper_median(residuals);
  for (double& r : residuals) r = std::abs(r - middle);
  return std::max(kLeastScale, upper_median(residuals) / kMedianOfNormal);
}

/// One marker's pixels under one response.
class ResponseFit {
 public:
  ResponseFit(const MarkerPixels& pixels, SensorResponse response)
      : pixels_(pixels), response_(response) {}

  /// From where the refined corners are. False where it did not come to rest near them.
  bool run() {
    constexpr double kStartBlur_px = 0.6;
    constexpr int kRounds = 3;
    return run(shape_at(pixels_.start(), kStartBlur_px), kRounds);
  }

  /// From where the other response's fit came to rest.
  bool run_from(const ResponseFit& other) {
    constexpr int kRounds = 2;
    return run(other.shape(), kRounds);
  }

  [[nodiscard]] const Scales& scales() const { return scales_; }

  /// Bounded squares in sigmas of `scales`.
  [[nodiscard]] double misfit(const Scales& scales) {
    if (!look(numbers_)) return 0;
    double sum = 0;
    for (std::size_t i = 0; i < whiteness_.size(); ++i) {
      const double r = residual(i) / (kBound * scales.at(whiteness_[i].value));
      sum += kBound * kBound * r * r / (1 + r * r);
    }
    return sum;
  }

  [[nodiscard]] MarkerFit result() const {
    MarkerFit fit;
    fit.corners = corners_of(shape());
    constexpr double kPixelVariance = 1.0 / 12;
    fit.blur_px = std::sqrt(std::exp(numbers_[kShapeBlur]) + kPixelVariance);
    fit.growth_px = numbers_[kShapeGrowth];
    const Eigen::Matrix<double, kNumbers, kNumbers> covariance =
        SymmetricFactor<kNumbers>(information_).inverse();
    fit.growth_sigma = std::sqrt(std::max(0.0, covariance(kShapeGrowth, kShapeGrowth)));
    fit.inset_px = inset_px(pixels_.start(), fit.corners);
    return fit;
  }

 private:
  bool run(const MarkerShape& start, int rounds) {
    numbers_.head<kShapeNumbers>() = start;
    if (!start_levels()) return false;
    // With the scale that the last round left.
    constexpr LevenbergMarquardtOptions kSteps{
        .max_iterations = 5, .initial_damping = 1e-3, .negligible_decrease = 1e-3};
    for (int round = 0; round < rounds; ++round) {
      if (!measure_scales()) return false;
      const auto optimum = minimize<kNumbers>(
          numbers_, kSteps, [&](const Numbers& at) { return linearize(at); }, moved);
      if (!optimum) return false;
      numbers_ = optimum->place;
      information_ = optimum->equations.hessian;
    }
    return measure_scales() && is_near_start();
  }

  /// Keeps blur and growth to what images show.
  static Numbers moved(const Numbers& from, const Numbers& step) {
    Numbers to = from + step;
    to[kShapeBlur] = std::clamp(to[kShapeBlur], 2 * std::log(0.05), 2 * std::log(6.0));
    const double ellipse = to.segment<2>(kShapeBlur + 1).norm();
    constexpr double kMostEllipse = 0.9;
    if (ellipse > kMostEllipse) to.segment<2>(kShapeBlur + 1) *= kMostEllipse / ellipse;
    to[kShapeGrowth] = std::clamp(to[kShapeGrowth], -3.0, 3.0);
    return to;
  }

  [[nodiscard]] MarkerShape shape() const { return numbers_.head<kShapeNumbers>(); }

  bool look(const Numbers& at) { return pixels_.look(at.head<kShapeNumbers>(), whiteness_); }

  /// Of pixel i, as looked at last, by the present levels.
  [[nodiscard]] double residual(std::size_t i) const {
    const MarkerPixel& pixel = pixels_.all()[i];
    const double light = light_of(pixel, whiteness_[i].value, numbers_.tail<kLevels>());
    return residual_of(pixel, encode(response_, light).grey);
  }

  /// Levels by linear least squares of the pixels' light.
  bool start_levels() {
    if (!look(numbers_)) return false;
    Eigen::Matrix<double, kLevels, kLevels> hessian =
        1e-9 * Eigen::Matrix<double, kLevels, kLevels>::Identity();
    Levels right = Levels::Zero();
    for (std::size_t i = 0; i < whiteness_.size(); ++i) {
      const MarkerPixel& pixel = pixels_.all()[i];
      Levels j;
      j << pixel.place.head<kBlackLevels>(), whiteness_[i].value * pixel.place;
      hessian += j * j.transpose();
      right += j * decode(response_, pixel.grey);
    }
    numbers_.tail<kLevels>() = SymmetricFactor<kLevels>(hessian).solve(right);
    return numbers_.allFinite();
  }

  bool measure_scales() {
    if (!look(numbers_)) return false;
    std::vector<double> edges;
    std::vector<double> rest;
    for (std::size_t i = 0; i < whiteness_.size(); ++i) {
      if (is_clipped(pixels_.all()[i].grey)) continue;
      (sees_an_edge(whiteness_[i].value) ? edges : rest).push_back(residual(i));
    }
    scales_ = {scale_of(edges), scale_of(rest)};
    return true;
  }

  [[nodiscard]] NormalEquations<kNumbers> linearize(const Numbers& at) {
    NormalEquations<kNumbers> equations;
    if (!look(at)) return equations;
    const Levels levels = at.tail<kLevels>();
    weighted_.resize(kNumbers, static_cast<Eigen::Index>(whiteness_.size()));
    for (std::size_t i = 0; i < whiteness_.size(); ++i) {
      const MarkerPixel& pixel = pixels_.all()[i];
      const double white = whiteness_[i].value;
      const EncodedLight expected = encode(response_, light_of(pixel, white, levels));
      const double r = residual_of(pixel, expected.grey);
      ++equations.corners;
      auto j = weighted_.col(static_cast<Eigen::Index>(i));
      if (r == 0) {
        j.setZero();
        continue;
      }
      const double scale = scales_.at(white);
      const double bounded = 1 / (1 + r * r / (kBound * kBound * scale * scale));
      equations.cost += r * r * bounded / (scale * scale);
      j << pixel.place.dot(levels.tail<kContrastLevels>()) * whiteness_[i].by_shape,
          pixel.place.head<kBlackLevels>(), white * pixel.place;
      const double weight = bounded / scale;  // its square is the observation's
      j *= -expected.slope * weight;
      equations.gradient += weight * r * j;
    }
    equations.hessian.selfadjointView<Eigen::Lower>().rankUpdate(weighted_);
    equations.hessian.triangularView<Eigen::StrictlyUpper>() = equations.hessian.transpose();
    return equations;
  }

  /// A fit that has left the refined corners by more than a good part of a cell explains another
  /// thing.
  [[nodiscard]] bool is_near_start() const {
    constexpr double kFarthest = 0.05;  // of the marker's side
    const ImageCorners corners = corners_of(shape());
    const double farthest_px = kFarthest * std::sqrt(area_px2(pixels_.start())) + 1.0;
    for (std::size_t i = 0; i < 4; ++i) {
      if (!((corners[i] - pixels_.start()[i]).norm() < farthest_px)) return false;
    }
    return true;
  }

  const MarkerPixels& pixels_;
  SensorResponse response_;
  Scales scales_;
  Numbers numbers_ = Numbers::Zero();
  Eigen::Matrix<double, kNumbers, kNumbers> information_;
  std::vector<PixelWhiteness> whiteness_;                     ///< as looked at last
  Eigen::Matrix<double, kNumbers, Eigen::Dynamic> weighted_;  ///< Jacobians, by their sigmas
};

double shortest_side_px(const ImageCorners& corners) {
  double shortest = (corners[0] - corners[3]).norm();
  for (std::size_t i = 0; i < 3; ++i) {
    shortest = std::min(shortest, (corners[i + 1] - corners[i]).norm());
  }
  return shortest;
}

double clipped_share(const std::vector<MarkerPixel>& pixels) {
  const auto clipped = std::count_if(pixels.begin(), pixels.end(),
                                     [](const MarkerPixel& p) { return is_clipped(p.grey); });
  return static_cast<double>(clipped) / static_cast<double>(pixels.size());
}

}  // namespace

std::optional<MarkerFits> fit_marker(const GrayView& image, const CameraModel& camera,
                                     const ImageCorners& corners, const MarkerBits& bits) {
  const MarkerPixels pixels(image, camera, corners, bits);
  if (pixels.all().size() < kFewestPixels) return std::nullopt;
  MarkerFits fits;
  fits.clipped_share = clipped_share(pixels.all());
  fits.cell_px = shortest_side_px(corners) / bits.cells;
  std::array<ResponseFit, 2> both{ResponseFit(pixels, SensorResponse::linear),
                                  ResponseFit(pixels, SensorResponse::srgb)};
  std::array<bool, 2> rests{};
  rests[0] = both[0].run();
  rests[1] = rests[0] ? both[1].run_from(both[0]) : both[1].run();
  if (!rests[0] && !rests[1]) return std::nullopt;
  // Both in the same unit, or they could not be compared.
  Scales common = both[rests[0] ? 0 : 1].scales();
  if (rests[0] && rests[1]) {
    common.edges = std::min(common.edges, both[1].scales().edges);
    common.rest = std::min(common.rest, both[1].scales().rest);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    if (!rests[i]) continue;
    fits.by_response[i] = both[i].result();
    fits.by_response[i]->misfit = both[i].misfit(common);
  }
  return fits;
}

}  // namespace waymark
