#include "core/detect/marker_fit.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "core/base/median.h"
#include "core/detect/blurred_marker.h"
#include "core/detect/marker_plane.h"
#include "core/geometry/levenberg_marquardt.h"
#include "core/geometry/square_homography.h"

namespace waymark {
namespace {

/// Numbers of a fit: eight of corners, three of blur, growth, three of black and six of contrast.
constexpr int kNumbers = 21;
constexpr int kBlur = 8;
constexpr int kGrowth = 11;
constexpr int kLevels = 12;
constexpr int kBlackLevels = 3;
constexpr int kContrastLevels = 6;
using Numbers = Eigen::Matrix<double, kNumbers, 1>;
using Levels = Eigen::Matrix<double, kBlackLevels + kContrastLevels, 1>;

constexpr std::size_t kMostPixels = 1600;
constexpr std::size_t kFewestPixels = 100;
/// Cells of paper around the marker that are looked at.
constexpr double kMargin = 0.55;
/// Grey values at which a pixel may be clipped, 0 black, 1 white.
constexpr double kWhiteEnd = 252.5 / 255;
constexpr double kBlackEnd = 1.5 / 255;
/// No image is steadier.
constexpr double kLeastScale = 0.3 / 255;
/// Geman and McClure's bound, in sigmas of the rest.
constexpr double kBound = 6.0;

/// A pixel that is explained.
struct Sample {
  Eigen::Vector2d plane;           ///< in the marker's plane
  Eigen::Matrix2d plane_from_px;   ///< derivative
  double grey = 0;                 ///< 0 black, 1 white
  Eigen::Matrix<double, 6, 1> on;  ///< 1 x y x² xy y², about ± 0.5 within the marker
};

bool is_clipped(double grey) { return grey >= kWhiteEnd || grey <= kBlackEnd; }

/// d plane / d pixel, by differences far above rounding and far below a lens's bend.
std::optional<Eigen::Matrix2d> plane_slope(const MarkerPlane& plane, const Eigen::Vector2d& pixel) {
  constexpr double kStep_px = 0.25;
  Eigen::Matrix2d slope;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d step = kStep_px * Eigen::Vector2d::Unit(axis);
    const auto after = plane.plane_from_pixel(pixel + step);
    const auto before = plane.plane_from_pixel(pixel - step);
    if (!after || !before) return std::nullopt;
    slope.col(axis) = (*after - *before) / (2 * kStep_px);
  }
  return slope;
}

/// Cells (x right, y down, from the top left corner) of points in the marker's plane.
class CellMap {
 public:
  static std::optional<CellMap> of(const ImageCorners& plane_corners, double cells) {
    const auto plane_from_unit = homography_from_unit_square(plane_corners);
    if (!plane_from_unit) return std::nullopt;
    Eigen::Matrix3d cells_from_plane;
    bool invertible = false;
    plane_from_unit->computeInverseWithCheck(cells_from_plane, invertible, 0.0);
    if (!invertible) return std::nullopt;
    cells_from_plane.topRows<2>() *= cells;
    return CellMap(cells_from_plane);
  }

  [[nodiscard]] Eigen::Vector2d at(const Eigen::Vector2d& plane) const {
    return (cells_from_plane_ * plane.homogeneous()).hnormalized();
  }

  /// d cells / d plane.
  [[nodiscard]] Eigen::Matrix2d slope(const Eigen::Vector2d& plane) const {
    const Eigen::Vector3d h = cells_from_plane_ * plane.homogeneous();
    return (cells_from_plane_.topLeftCorner<2, 2>() -
            h.hnormalized() * cells_from_plane_.bottomLeftCorner<1, 2>()) /
           h.z();
  }

 private:
  explicit CellMap(const Eigen::Matrix3d& cells_from_plane) : cells_from_plane_(cells_from_plane) {}
  Eigen::Matrix3d cells_from_plane_;
};

/// Pixels of a marker, and what it looks like under given numbers.
class MarkerPixels {
 public:
  MarkerPixels(const CameraModel& camera, const ImageCorners& corners, const MarkerBits& bits)
      : start_(corners), cells_(bits.cells), marker_(bits) {
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& corner : corners) middle += 0.25 * corner;
    if (const auto axis = camera.bearing(middle)) plane_.emplace(camera, *axis);
  }

  /// Whether there is enough to explain.
  [[nodiscard]] bool take(const GrayView& image) {
    const auto start_map = plane_ ? map_of(start_) : std::nullopt;
    if (!start_map) return false;
    Eigen::Vector2d low = start_[0];
    Eigen::Vector2d high = start_[0];
    for (const Eigen::Vector2d& corner : start_) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
    const Eigen::Vector2d margin = Eigen::Vector2d::Constant(1.0) + (high - low) * 2 / cells_;
    const auto from = [](double value) { return std::max(0, static_cast<int>(value)); };
    const int x_end = std::min(image.width_px - 1, from(high.x() + margin.x()));
    const int y_end = std::min(image.height_px - 1, from(high.y() + margin.y()));
    std::vector<Eigen::Vector2i> all;
    for (int y = from(low.y() - margin.y()); y <= y_end; ++y) {
      for (int x = from(low.x() - margin.x()); x <= x_end; ++x) {
        if (within(*start_map, Eigen::Vector2d(x, y))) all.emplace_back(x, y);
      }
    }
    std::mt19937_64 random(1);
    if (all.size() > kMostPixels) {
      for (std::size_t i = 0; i < kMostPixels; ++i) {
        std::swap(all[i], all[i + random() % (all.size() - i)]);
      }
      all.resize(kMostPixels);
    }
    for (const Eigen::Vector2i& pixel : all) add(image, *start_map, pixel);
    return samples_.size() >= kFewestPixels;
  }

  [[nodiscard]] double clipped_share() const {
    const auto clipped = std::count_if(samples_.begin(), samples_.end(),
                                       [](const Sample& s) { return is_clipped(s.grey); });
    return static_cast<double>(clipped) / static_cast<double>(samples_.size());
  }

  [[nodiscard]] const std::vector<Sample>& samples() const { return samples_; }
  [[nodiscard]] const ImageCorners& start() const { return start_; }

  /// Looks at every sample with the marker at the numbers' corners: `use(sample, whiteness,
  /// d whiteness / d the first twelve numbers)`. False where the corners are none.
  template <typename Use>
  [[nodiscard]] bool look(const Numbers& numbers, const Use& use) const {
    const ImageCorners corners = corners_of(numbers);
    const auto map = map_of(corners);
    if (!map) return false;
    std::array<std::optional<CellMap>, 8> moved;
    for (std::size_t i = 0; i < 8; ++i) {
      ImageCorners other = corners;
      other[i / 2][static_cast<Eigen::Index>(i % 2)] += kCornerStep_px;
      moved[i] = map_of(other);
      if (!moved[i]) return false;
    }
    for (const Sample& sample : samples_) {
      const Eigen::Vector2d at = map->at(sample.plane);
      const Eigen::Matrix2d slope = map->slope(sample.plane) * sample.plane_from_px;
      std::array<AxisView, 2> views;
      std::array<Eigen::Vector3d, 2> d_blur;
      for (int axis = 0; axis < 2; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        const double cells_per_px = slope.row(axis).norm();
        const Eigen::Vector2d across = slope.row(axis).transpose() / cells_per_px;
        views[a] = {at[axis], cells_per_px, blur_across(numbers, across, d_blur[a])};
      }
      const Whiteness w = marker_.at(views[0], views[1], numbers[kGrowth]);
      Eigen::Matrix<double, kLevels, 1> d;
      for (std::size_t i = 0; i < 8; ++i) {
        d[static_cast<Eigen::Index>(i)] =
            w.d_place.dot(moved[i]->at(sample.plane) - at) / kCornerStep_px;
      }
      d.segment<3>(kBlur) = w.d_blur.x() * d_blur[0] + w.d_blur.y() * d_blur[1];
      d[kGrowth] = w.d_growth;
      use(sample, w.value, d);
    }
    return true;
  }

  [[nodiscard]] ImageCorners corners_of(const Numbers& numbers) const {
    ImageCorners corners;
    for (Eigen::Index i = 0; i < 4; ++i) {
      corners[static_cast<std::size_t>(i)] = numbers.segment<2>(2 * i);
    }
    return corners;
  }

 private:
  static constexpr double kCornerStep_px = 0.01;

  [[nodiscard]] std::optional<CellMap> map_of(const ImageCorners& corners) const {
    ImageCorners in_plane;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto point = plane_->plane_from_pixel(corners[i]);
      if (!point) return std::nullopt;
      in_plane[i] = *point;
    }
    return CellMap::of(in_plane, cells_);
  }

  [[nodiscard]] bool within(const CellMap& map, const Eigen::Vector2d& pixel) const {
    const auto plane = plane_->plane_from_pixel(pixel);
    if (!plane) return false;
    const Eigen::Vector2d at = map.at(*plane);
    return at.minCoeff() >= -kMargin && at.maxCoeff() <= cells_ + kMargin;
  }

  void add(const GrayView& image, const CellMap& map, const Eigen::Vector2i& pixel) {
    const Eigen::Vector2d place = pixel.cast<double>();
    const auto plane = plane_->plane_from_pixel(place);
    const auto slope = plane_slope(*plane_, place);
    if (!plane || !slope) return;
    const Eigen::Vector2d x = map.at(*plane) / cells_ - Eigen::Vector2d::Constant(0.5);
    Sample sample{*plane, *slope, image.row(pixel.y())[pixel.x()] / 255.0, {}};
    sample.on << 1, x.x(), x.y(), x.x() * x.x(), x.x() * x.y(), x.y() * x.y();
    samples_.push_back(sample);
  }

  /// Standard deviation (px) of the blur in a direction, with derivatives by its three numbers:
  /// ln variance, and how much more of it lies along x than y, and along the diagonal.
  static double blur_across(const Numbers& numbers, const Eigen::Vector2d& across,
                            Eigen::Vector3d& d) {
    const double variance = std::exp(numbers[kBlur]);
    const double along_x = across.x() * across.x() - across.y() * across.y();
    const double diagonal = 2 * across.x() * across.y();
    const double blur = std::sqrt(variance * std::max(0.01, 1 + numbers[kBlur + 1] * along_x +
                                                                numbers[kBlur + 2] * diagonal));
    d << blur / 2, variance * along_x / (2 * blur), variance * diagonal / (2 * blur);
    return blur;
  }

  ImageCorners start_;
  double cells_;
  BlurredMarker marker_;
  std::optional<MarkerPlane> plane_;
  std::vector<Sample> samples_;
};

/// What a sample is under some levels of light.
double light_of(const Sample& sample, double white, const Levels& levels) {
  return sample.on.head<kBlackLevels>().dot(levels.head<kBlackLevels>()) +
         sample.on.dot(levels.tail<kContrastLevels>()) * white;
}

/// Grey seen less grey expected; nothing where both are clipped.
double residual_of(const Sample& sample, double expected) {
  const bool both = (sample.grey >= kWhiteEnd && expected >= kWhiteEnd) ||
                    (sample.grey <= kBlackEnd && expected <= kBlackEnd);
  return both ? 0.0 : sample.grey - expected;
}

/// Noise, of pixels that see an edge and of the others: what is wrong with a lens or a print shows
/// at edges alone.
struct Scales {
  double edges = kLeastScale;
  double rest = kLeastScale;

  [[nodiscard]] double at(double white) const {
    return white > 0.04 && white < 0.96 ? edges : rest;
  }
};

double scale_of(std::vector<double>& residuals) {
  if (residuals.empty()) return kLeastScale;
  const double middle = upper_median(residuals);
  for (double& r : residuals) r = std::abs(r - middle);
  return std::max(kLeastScale, upper_median(residuals) / kMedianOfNormal);
}

class ResponseFit {
 public:
  ResponseFit(const MarkerPixels& pixels, SensorResponse response)
      : pixels_(pixels), response_(response) {}

  /// False where it did not come to rest near its start.
  bool run() {
    constexpr double kStartBlur_px = 0.6;
    Numbers numbers = Numbers::Zero();
    for (Eigen::Index i = 0; i < 4; ++i) {
      numbers.segment<2>(2 * i) = pixels_.start()[static_cast<std::size_t>(i)];
    }
    numbers[kBlur] = 2 * std::log(kStartBlur_px);
    if (!start_levels(numbers)) return false;
    // With the scale that the last round left.
    constexpr int kRounds = 3;
    constexpr LevenbergMarquardtOptions kSteps{
        .max_iterations = 5, .initial_damping = 1e-3, .negligible_decrease = 1e-3};
    for (int round = 0; round < kRounds; ++round) {
      if (!measure_scales(numbers)) return false;
      const auto optimum = minimize<kNumbers>(
          numbers, kSteps, [&](const Numbers& at) { return linearize(at); }, moved);
      if (!optimum) return false;
      numbers = optimum->place;
      information_ = optimum->equations.hessian;
    }
    numbers_ = numbers;
    return measure_scales(numbers_) && is_near_start();
  }

  [[nodiscard]] const Scales& scales() const { return scales_; }

  /// Bounded squares in sigmas of `scales`.
  [[nodiscard]] double misfit(const Scales& scales) const {
    double sum = 0;
    const bool looked =
        pixels_.look(numbers_, [&](const Sample& sample, double white, const auto&) {
          const double r = residual(sample, white, numbers_) / (kBound * scales.at(white));
          sum += kBound * kBound * r * r / (1 + r * r);
        });
    return looked ? sum : 0;
  }

  [[nodiscard]] MarkerFit result() const {
    MarkerFit fit;
    fit.corners = pixels_.corners_of(numbers_);
    constexpr double kPixelVariance = 1.0 / 12;
    fit.blur_px = std::sqrt(std::exp(numbers_[kBlur]) + kPixelVariance);
    fit.growth_px = numbers_[kGrowth];
    const Eigen::Matrix<double, kNumbers, kNumbers> covariance =
        SymmetricFactor<kNumbers>(information_).inverse();
    fit.growth_sigma = std::sqrt(std::max(0.0, covariance(kGrowth, kGrowth)));
    fit.inset_px = inset(pixels_.start(), fit.corners);
    return fit;
  }

 private:
  /// Keeps blur and growth to what images show.
  static Numbers moved(const Numbers& from, const Numbers& step) {
    Numbers to = from + step;
    to[kBlur] = std::clamp(to[kBlur], 2 * std::log(0.05), 2 * std::log(6.0));
    const double ellipse = to.segment<2>(kBlur + 1).norm();
    constexpr double kMostEllipse = 0.9;
    if (ellipse > kMostEllipse) to.segment<2>(kBlur + 1) *= kMostEllipse / ellipse;
    to[kGrowth] = std::clamp(to[kGrowth], -3.0, 3.0);
    return to;
  }

  [[nodiscard]] double residual(const Sample& sample, double white, const Numbers& at) const {
    return residual_of(
        sample,
        encode(response_, light_of(sample, white, at.tail<Levels::SizeAtCompileTime>())).grey);
  }

  /// Levels by linear least squares of the light of unclipped pixels.
  bool start_levels(Numbers& numbers) const {
    Eigen::Matrix<double, 9, 9> hessian = 1e-9 * Eigen::Matrix<double, 9, 9>::Identity();
    Levels right = Levels::Zero();
    const bool looked = pixels_.look(numbers, [&](const Sample& sample, double white, const auto&) {
      Levels j;
      j << sample.on.head<kBlackLevels>(), white * sample.on;
      hessian += j * j.transpose();
      right += j * decode(response_, sample.grey);
    });
    numbers.tail<9>() = SymmetricFactor<9>(hessian).solve(right);
    return looked && numbers.allFinite();
  }

  bool measure_scales(const Numbers& numbers) {
    std::vector<double> edges;
    std::vector<double> rest;
    const bool looked = pixels_.look(numbers, [&](const Sample& sample, double white, const auto&) {
      if (is_clipped(sample.grey)) return;
      (white > 0.04 && white < 0.96 ? edges : rest).push_back(residual(sample, white, numbers));
    });
    scales_ = {scale_of(edges), scale_of(rest)};
    return looked;
  }

  [[nodiscard]] NormalEquations<kNumbers> linearize(const Numbers& at) const {
    NormalEquations<kNumbers> equations;
    const Levels levels = at.tail<9>();
    const bool looked =
        pixels_.look(at, [&](const Sample& sample, double white, const auto& d_white) {
          const EncodedLight expected = encode(response_, light_of(sample, white, levels));
          const double r = residual_of(sample, expected.grey);
          ++equations.corners;
          const double bound = kBound * scales_.at(white);
          const double bounded = 1 / (1 + r * r / (bound * bound));
          const double scale2 = scales_.at(white) * scales_.at(white);
          equations.cost += r * r * bounded / scale2;
          if (r == 0) return;
          Numbers j;
          j.head<kLevels>() =
              -expected.slope * sample.on.dot(levels.tail<kContrastLevels>()) * d_white;
          j.segment<kBlackLevels>(kLevels) = -expected.slope * sample.on.head<kBlackLevels>();
          j.tail<kContrastLevels>() = -expected.slope * white * sample.on;
          const double weight = bounded * bounded / scale2;
          equations.hessian.noalias() += (weight * j) * j.transpose();
          equations.gradient += weight * r * j;
        });
    if (!looked) equations.corners = 0;
    return equations;
  }

  /// A fit that has left the refined sides by more than a good part of a cell explains another
  /// thing.
  [[nodiscard]] bool is_near_start() const {
    constexpr double kFarthest = 0.05;  // of the marker's side
    const ImageCorners corners = pixels_.corners_of(numbers_);
    const double side_px = std::sqrt(area_px2(pixels_.start()));
    for (std::size_t i = 0; i < 4; ++i) {
      if (!((corners[i] - pixels_.start()[i]).norm() < kFarthest * side_px + 1.0)) return false;
    }
    return true;
  }

  static double inset(const ImageCorners& given, const ImageCorners& fitted) {
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& corner : fitted) middle += 0.25 * corner;
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector2d along = fitted[(i + 1) % 4] - fitted[i];
      Eigen::Vector2d inward = Eigen::Vector2d(-along.y(), along.x()).normalized();
      if (inward.dot(middle - fitted[i]) < 0) inward = -inward;
      sum += 0.125 * inward.dot(given[i] + given[(i + 1) % 4] - fitted[i] - fitted[(i + 1) % 4]);
    }
    return sum;
  }

  const MarkerPixels& pixels_;
  SensorResponse response_;
  Scales scales_;
  Numbers numbers_ = Numbers::Zero();
  Eigen::Matrix<double, kNumbers, kNumbers> information_;
};

double shortest_side_px(const ImageCorners& corners) {
  double shortest = (corners[0] - corners[3]).norm();
  for (std::size_t i = 0; i < 3; ++i) {
    shortest = std::min(shortest, (corners[i + 1] - corners[i]).norm());
  }
  return shortest;
}

}  // namespace

std::optional<MarkerFits> fit_marker(const GrayView& image, const CameraModel& camera,
                                     const ImageCorners& corners, const MarkerBits& bits) {
  MarkerPixels pixels(camera, corners, bits);
  if (!pixels.take(image)) return std::nullopt;
  MarkerFits fits;
  fits.clipped_share = pixels.clipped_share();
  fits.cell_px = shortest_side_px(corners) / bits.cells;
  std::array<ResponseFit, 2> both{ResponseFit(pixels, SensorResponse::linear),
                                  ResponseFit(pixels, SensorResponse::srgb)};
  std::array<bool, 2> rests{};
  for (std::size_t i = 0; i < 2; ++i) rests[i] = both[i].run();
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
