#include "core/detect/corner_refiner.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/detect/cell_steps.h"
#include "core/detect/image_side.h"
#include "core/detect/marker_plane.h"
#include "core/detect/side_brake.h"
#include "core/detect/side_fit.h"
#include "core/detect/side_search.h"
#include "core/geometry/line2.h"

namespace waymark {
namespace {

using Failure = RefineFailure;
using Quad = std::array<Eigen::Vector2d, 4>;  // in the marker plane or in pixels

/// Turns twice the area of every corner's triangle the right way: clockwise as the image shows it.
bool convex_and_clockwise(const Quad& quad) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d in = quad[i] - quad[(i + 3) % 4];
    const Eigen::Vector2d out = quad[(i + 1) % 4] - quad[i];
    if (!(in.x() * out.y() - in.y() * out.x() > 0)) return false;
  }
  return true;
}

/// How much of what a side shows may be the light's doing. Sigmas as shares of the contrast.
struct LightPrior {
  double grey;  ///< of black and white about the plane through all sides' greys
  double
      saturated;  ///< of white besides, where it is saturated: its edge alone can tell how bright
  double uneven;  ///< of a side's unevenness
};
constexpr LightPrior kAnyLight{0.04, 0.1, 0.1};
constexpr LightPrior kEvenLight{0.04, 0, 0.003};

/// The marker's four sides as they are known so far.
class Refinement {
 public:
  Refinement(const GrayView& image, const CameraModel& camera, const Quad& rough,
             const MarkerBits& bits, const RefineOptions& options, const LightPrior& light)
      : image_(image),
        rough_(rough),
        bits_(bits),
        options_(options),
        light_(light),
        plane_(camera, axis(camera)) {}

  std::optional<Failure> run();
  [[nodiscard]] RefinedCorners result() const;

 private:
  [[nodiscard]] Eigen::Vector3d axis(const CameraModel& camera) const;
  std::optional<Failure> place_rough_corners();
  std::optional<Failure> search();
  std::optional<Failure> fit_until_still();
  std::optional<Failure> fit_once(int max_columns);
  std::optional<Failure> look_at_sides();
  std::optional<Failure> move_sides(const std::array<Eigen::Vector2d, 4>& shifts_px);
  void share_appearance(double log_blur_sigma);
  [[nodiscard]] double border_px(std::size_t side) const;
  [[nodiscard]] double shift_sigma_px() const;
  [[nodiscard]] double shift_variance(std::size_t side, Eigen::Index end) const;
  [[nodiscard]] std::optional<Failure> judge() const;

  const GrayView& image_;
  const Quad& rough_;
  const MarkerBits& bits_;
  const RefineOptions& options_;
  LightPrior light_;
  MarkerPlane plane_;
  Quad corners_;         // in the marker plane
  ImageCorners pixels_;  // of the corners
  std::array<std::optional<ImageSide>, 4> sides_;
  std::array<SideAppearance, 4> appearances_;
  std::array<SidePrior, 4> priors_;
  std::array<SideStep, 4> steps_;
  std::array<SideBrake, 4> brakes_;
  double last_shift_px_ = 0;  ///< farthest of any side
};

Eigen::Vector3d Refinement::axis(const CameraModel& camera) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector2d& corner : rough_) {
    if (const auto bearing = camera.bearing(corner)) sum += *bearing;
  }
  return sum.norm() > 0 ? Eigen::Vector3d(sum.normalized()) : Eigen::Vector3d::UnitZ();
}

std::optional<Failure> Refinement::place_rough_corners() {
  for (std::size_t i = 0; i < 4; ++i) {
    // A corner that the image does not show can't be refined.
    const Eigen::Vector2d& pixel = rough_[i];
    const double margin = options_.max_shift_px;
    if (!(pixel.x() > -margin && pixel.x() < image_.width_px + margin && pixel.y() > -margin &&
          pixel.y() < image_.height_px + margin)) {
      return Failure::outside_camera;
    }
    const auto point = plane_.plane_from_pixel(pixel);
    if (!point) return Failure::outside_camera;
    corners_[i] = *point;
  }
  return look_at_sides();
}

/// Brings the image's view of the sides up to date with the corners.
std::optional<Failure> Refinement::look_at_sides() {
  for (std::size_t i = 0; i < 4; ++i) {
    sides_[i] =
        ImageSide::create(plane_, corners_[i], corners_[(i + 1) % 4], appearances_[i].bow_px);
    if (!sides_[i]) return Failure::outside_camera;
    pixels_[i] = sides_[i]->start_px();
  }
  if (!convex_and_clockwise(pixels_)) return Failure::outside_camera;
  return std::nullopt;
}

double Refinement::border_px(std::size_t side) const {
  const CellSteps cells(pixels_, side, bits_);
  const double width = cells
                           .behind(sides_[side]->point_px(0.5), -sides_[side]->outward(),
                                   sides_[side]->along(), 1.0, 0.0)
                           .border_px;
  constexpr double kMaxBorderPx = 1e4;
  return width > 0 && width < kMaxBorderPx ? width : 1.0;
}

/// Shifts each side's line outward at its ends, and intersects the lines anew.
std::optional<Failure> Refinement::move_sides(const std::array<Eigen::Vector2d, 4>& shifts_px) {
  constexpr double kLeastSine = 1e-3;
  std::array<Line2, 4> lines;
  for (std::size_t i = 0; i < 4; ++i) {
    const ImageSide& side = *sides_[i];
    const auto start = plane_.plane_from_pixel(side.start_px() + shifts_px[i][0] * side.outward());
    const auto end = plane_.plane_from_pixel(side.end_px() + shifts_px[i][1] * side.outward());
    if (!start || !end) return Failure::outside_camera;
    lines[i] = {*start, *end - *start};
  }
  for (std::size_t i = 0; i < 4; ++i) {
    const auto corner = intersection(lines[(i + 3) % 4], lines[i], kLeastSine);
    if (!corner) return Failure::not_converged;
    corners_[i] = *corner;
  }
  const auto failure = look_at_sides();
  if (failure) return Failure::not_converged;
  for (std::size_t i = 0; i < 4; ++i) {
    // A corner between two sides that each moved that far moves √2 times as far, more if it is
    // acute.
    if ((pixels_[i] - rough_[i]).norm() > 2.5 * options_.max_shift_px)
      return Failure::not_converged;
  }
  return std::nullopt;
}

/// Takes the sides from the rough corners to within a fraction of a pixel; the second look starts
/// from straightened sides.
std::optional<Failure> Refinement::search() {
  constexpr int kLooks = 2;
  for (int look = 0; look < kLooks; ++look) {
    std::array<Eigen::Vector2d, 4> shifts_px;
    double farthest_px = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const double reach_px = std::clamp(1.2 * border_px(i), 1.5, options_.max_shift_px);
      const auto found = search_side(image_, *sides_[i], reach_px);
      if (!found) return Failure::no_edge;
      if (found->white_grey - found->black_grey < options_.min_contrast_grey) {
        return Failure::low_contrast;
      }
      shifts_px[i] = found->shift_px;
      farthest_px = std::max(farthest_px, found->shift_px.cwiseAbs().maxCoeff());
      SideAppearance& appearance = appearances_[i];
      appearance.black_grey.setConstant(found->black_grey);
      appearance.white_grey.setConstant(found->white_grey);
      appearance.bow_px += found->bow_px;
      appearance.blur_px = found->blur_px;
      appearance.noise_grey = 0.1 * appearance.contrast_grey();
    }
    if (const auto failure = move_sides(shifts_px)) return failure;
    if (farthest_px < 1) break;
  }
  constexpr double kUnknownLogBlurSigma = 0.7;
  share_appearance(kUnknownLogBlurSigma);
  return std::nullopt;
}

/// Prior of every side: greys from the plane through all sides' greys over the image, blur from its
/// own and the opposite side's, which blur alike even when the camera moves.
void Refinement::share_appearance(double log_blur_sigma) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
  const auto at = [&](std::size_t corner) {
    const Eigen::Vector2d offset = pixels_[corner] - pixels_[0];
    return Eigen::Vector3d(1, offset.x(), offset.y());
  };
  double contrast = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const double weight = border_px(i);  // a wide border shows its greys better
    for (std::size_t end = 0; end < 2; ++end) {
      const Eigen::Vector3d x = at((i + end) % 4);
      const auto e = static_cast<Eigen::Index>(end);
      information += weight * x * x.transpose();
      right += weight * x *
               Eigen::RowVector2d(appearances_[i].black_grey[e], appearances_[i].white_grey[e]);
    }
    contrast += 0.25 * appearances_[i].contrast_grey();
  }
  const Eigen::Matrix<double, 3, 2> greys = information.ldlt().solve(right);
  for (std::size_t i = 0; i < 4; ++i) {
    SidePrior& prior = priors_[i];
    for (std::size_t end = 0; end < 2; ++end) {
      const Eigen::RowVector2d grey = at((i + end) % 4).transpose() * greys;
      const auto e = static_cast<Eigen::Index>(end);
      prior.mean.black_grey[e] = grey[0];
      prior.mean.white_grey[e] = grey[1];
    }
    prior.black_sigma = light_.grey * contrast;
    prior.white_sigma = (light_.grey + light_.saturated * steps_[i].saturated_share) * contrast;
    prior.uneven_sigma = light_.uneven * contrast;
    const std::size_t opposite = (i + 2) % 4;
    const double own = 1e-9 + steps_[i].information_blur;
    const double other = 1e-9 + steps_[opposite].information_blur;
    prior.mean.blur_px = std::exp((own * std::log(appearances_[i].blur_px) +
                                   other * std::log(appearances_[opposite].blur_px)) /
                                  (own + other));
    prior.log_blur_sigma = log_blur_sigma;
    if (options_.blur) {
      prior.mean.blur_px = std::exp(options_.blur->log_px);
      prior.log_blur_sigma = options_.blur->log_sigma;
    }
  }
}

std::optional<Failure> Refinement::fit_once(int max_columns) {
  std::array<Eigen::Vector2d, 4> shifts_px;
  last_shift_px_ = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const CellSteps cells(pixels_, i, bits_);
    const SideScene scene{*sides_[i], *sides_[(i + 3) % 4], *sides_[(i + 1) % 4],
                          *sides_[(i + 2) % 4], cells};
    const auto step = fit_side(image_, scene, appearances_[i], priors_[i], max_columns);
    if (!step) return Failure::too_small;
    steps_[i] = *step;
    brakes_[i].slow(appearances_[i], steps_[i]);
    constexpr double kMaxStepPx = 1;
    shifts_px[i] = steps_[i].shift_px.cwiseMax(-kMaxStepPx).cwiseMin(kMaxStepPx);
    last_shift_px_ = std::max(last_shift_px_, shifts_px[i].cwiseAbs().maxCoeff());
  }
  for (std::size_t i = 0; i < 4; ++i) {
    appearances_[i] = steps_[i].appearance;
    if (appearances_[i].contrast_grey() < options_.min_contrast_grey) return Failure::low_contrast;
  }
  if (const auto failure = move_sides(shifts_px)) return failure;
  constexpr double kLogBlurSigma = 0.1;
  share_appearance(kLogBlurSigma);
  return std::nullopt;
}

std::optional<Failure> Refinement::fit_until_still() {
  constexpr int kMaxPasses = 16;
  constexpr int kCoarsePasses = 2;
  constexpr double kStillPx = 0.003;  // or a quarter of the shifts' standard deviation
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    const bool coarse = pass < kCoarsePasses;
    const int columns = coarse ? std::min(24, options_.max_columns) : options_.max_columns;
    if (const auto failure = fit_once(columns)) return failure;
    if (!coarse && last_shift_px_ < std::max(kStillPx, 0.25 * shift_sigma_px())) return judge();
  }
  constexpr double kNearlyStillPx = 0.1;
  return last_shift_px_ < kNearlyStillPx ? judge() : Failure::not_converged;
}

/// Smallest standard deviation of any side's shift.
double Refinement::shift_sigma_px() const {
  double variance = steps_[0].covariance(0, 0);
  for (const SideStep& step : steps_) {
    variance = std::min(variance, step.covariance.diagonal().minCoeff());
  }
  return std::sqrt(variance);
}

std::optional<Failure> Refinement::judge() const {
  // Half a side's weight lost, or residuals of a quarter of the contrast, mean that something else
  // than this marker's edge is there.
  constexpr double kMaxOutlierShare = 0.5;
  constexpr double kMaxRelativeResidual = 0.25;
  for (std::size_t i = 0; i < 4; ++i) {
    const SideAppearance& appearance = appearances_[i];
    if (steps_[i].outlier_share > kMaxOutlierShare ||
        appearance.noise_grey > kMaxRelativeResidual * appearance.contrast_grey()) {
      return Failure::covered;
    }
  }
  return std::nullopt;
}

std::optional<Failure> Refinement::run() {
  if (const auto failure = place_rough_corners()) return failure;
  if (const auto failure = search()) return failure;
  return fit_until_still();
}

/// Variance (px²) of a side's place at its start (0) or end (1).
double Refinement::shift_variance(std::size_t side, Eigen::Index end) const {
  // What the last pass still moved is error too. Where all paper is saturated, only the step's foot
  // is seen, and what is extrapolated from it lies up to a part of the blur off; the first
  // unsaturated paper already tells how bright it is (measured on rendered rooms below lamps).
  constexpr double kSaturationBlurs = 0.08;
  const double share2 = steps_[side].saturated_share * steps_[side].saturated_share;
  const double hidden_px = kSaturationBlurs * share2 * share2 * appearances_[side].blur_px;
  return steps_[side].covariance(end, end) + last_shift_px_ * last_shift_px_ +
         hidden_px * hidden_px;
}

RefinedCorners Refinement::result() const {
  RefinedCorners refined;
  refined.corners = pixels_;
  double squares = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t before = (i + 3) % 4;
    // The corner moves by x where both sides' lines move: outward · x = shift.
    Eigen::Matrix2d outward;
    outward << sides_[before]->outward().transpose(), sides_[i]->outward().transpose();
    const Eigen::Matrix2d x_from_shift = outward.inverse();
    const Eigen::Vector2d variances(shift_variance(before, 1), shift_variance(i, 0));
    refined.covariances[i] =
        x_from_shift * variances.asDiagonal() * x_from_shift.transpose() +
        options_.model_sigma_px * options_.model_sigma_px * Eigen::Matrix2d::Identity();
    refined.blur_px += 0.25 * appearances_[i].blur_px;
    refined.side_blurs[i] = {std::log(appearances_[i].blur_px), steps_[i].information_blur};
    refined.contrast_grey += 0.25 * appearances_[i].contrast_grey();
    refined.bow_px = std::max(refined.bow_px, std::abs(appearances_[i].bow_px));
    refined.saturated_share += 0.25 * steps_[i].saturated_share;
    squares += 0.25 * appearances_[i].noise_grey * appearances_[i].noise_grey;
  }
  refined.residual_grey = std::sqrt(squares);
  return refined;
}

}  // namespace

std::string_view to_string(RefineFailure failure) {
  switch (failure) {
    case RefineFailure::outside_camera:
      return "outside the camera's domain";
    case RefineFailure::no_edge:
      return "a side has no edge within reach";
    case RefineFailure::too_small:
      return "a side is too short";
    case RefineFailure::low_contrast:
      return "too little contrast";
    case RefineFailure::covered:
      return "a side is covered or stained";
    case RefineFailure::not_converged:
      return "the sides did not settle near the rough corners";
  }
  return "unknown";
}

Status RefineOptions::check() const {
  return RangeCheck()
      .field("max_shift_px", max_shift_px, {1, 14})
      .field("min_contrast_grey", min_contrast_grey, {1, 255})
      .field("max_columns", max_columns, {8, 1000})
      .field("model_sigma_px", model_sigma_px, {0, 1})
      .status();
}

tl::expected<RefinedCorners, RefineFailure> refine_corners(const GrayView& image,
                                                           const CameraModel& camera,
                                                           const ImageCorners& rough,
                                                           const MarkerBits& bits,
                                                           const RefineOptions& options) {
  WAYMARK_CHECK(options.check().has_value());
  Refinement refinement(image, camera, rough, bits, options, kAnyLight);
  const auto failure = refinement.run();
  if (!failure) return refinement.result();
  if (*failure != Failure::not_converged && *failure != Failure::covered) {
    return tl::unexpected(*failure);
  }
  // Bent or stained paper: what light and bow may explain alike is left to the bow then.
  Refinement plainer(image, camera, rough, bits, options, kEvenLight);
  if (plainer.run()) return tl::unexpected(*failure);
  return plainer.result();
}

}  // namespace waymark
