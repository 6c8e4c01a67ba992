#include "tests/support/corner_trials.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <numbers>
#include <random>

#include "core/base/check.h"

namespace waymark::testing {
namespace {

constexpr std::array kFamilies{Family::aruco_4x4_1000, Family::aruco_5x5_1000,
                               Family::aruco_7x7_1000, Family::tag36h11, Family::aruco_original};

/// Numbers that are the same in every run.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : generator_(seed) {}

  double between(double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>(0, 1)(generator_);
  }

 private:
  std::mt19937_64 generator_;
};

RenderedMarker random_marker(const CameraModel& camera, const CornerTrials& trials, int trial,
                             Dice& dice) {
  constexpr double kRadPerDeg = std::numbers::pi / 180;
  RenderedMarker marker;
  const Family family = kFamilies[static_cast<std::size_t>(trial) % kFamilies.size()];
  marker.id = {family, static_cast<int>(dice.between(0, traits(family).id_count))};
  marker.quiet_zone_cells = trials.quiet_zone_cells;
  marker.white = trials.white;
  MarkerView view;
  view.mean_side_px = dice.between(trials.min_side_px, trials.max_side_px);
  view.tilt_rad = kRadPerDeg * dice.between(trials.min_tilt_deg, trials.max_tilt_deg);
  view.azimuth_rad = dice.between(0, 2 * std::numbers::pi);
  view.roll_rad = dice.between(0, 2 * std::numbers::pi);
  const double width = camera.parameters().width_px;
  const double height = camera.parameters().height_px;
  const double margin = std::min(1.3 * view.mean_side_px + 10, 0.5 * std::min(width, height));
  view.center_px = {dice.between(margin, width - margin), dice.between(margin, height - margin)};
  marker.cam_from_marker = pose_seen_as(camera, view, marker.size_m);
  return marker;
}

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Adds one marker's errors to the sums that `errors` holds until the end.
void add_errors(const ImageCorners& truth, const RefinedCorners& refined, CornerErrors& errors) {
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t next = (i + 1) % 4;
    const Eigen::Vector2d error = refined.corners[i] - truth[i];
    errors.rms_px += error.squaredNorm() / 2;
    errors.max_px = std::max(errors.max_px, error.norm());
    errors.normalized_squares += error.dot(refined.covariances[i].inverse() * error);
    const Eigen::Vector2d along = (truth[next] - truth[i]).normalized();
    const Eigen::Vector2d outward(along.y(), -along.x());
    errors.edge_bias_px += 0.5 * outward.dot(error + refined.corners[next] - truth[next]);
  }
  ++errors.refined;
}

}  // namespace

CornerErrors run_corner_trials(const CameraModel& camera, const CornerTrials& trials) {
  CornerErrors errors;
  Dice dice(trials.image.seed);
  for (int trial = 0; trial < trials.count; ++trial) {
    const RenderedMarker marker = random_marker(camera, trials, trial, dice);
    RenderOptions options = trials.image;
    options.seed += static_cast<std::uint64_t>(trial);
    const GrayImage image = render_markers(camera, {&marker, 1}, options);
    const ImageCorners truth = true_corners(camera, marker);
    ImageCorners rough = truth;
    for (Eigen::Vector2d& corner : rough) {
      corner.x() += dice.between(-trials.rough_px, trials.rough_px);
      corner.y() += dice.between(-trials.rough_px, trials.rough_px);
    }
    const MarkerBits bits = marker_bits(marker.id);
    const double begin = processor_seconds();
    const auto refined = refine_corners(image.view(), camera, rough, bits, trials.refine);
    errors.mean_us += 1e6 * (processor_seconds() - begin);
    if (refined) {
      add_errors(truth, *refined, errors);
    } else {
      ++errors.failures[std::string(to_string(refined.error()))];
    }
  }
  const double corners = std::max(1, 4 * errors.refined);
  errors.rms_px = std::sqrt(errors.rms_px / corners);
  errors.edge_bias_px /= corners;
  errors.normalized_squares /= corners;
  errors.mean_us /= std::max(1, trials.count);
  return errors;
}

CameraModel trial_camera(Distortion distortion) {
  CameraParameters parameters{320, 320, 400, 400, 159.5, 159.5, distortion, {}};
  if (distortion == Distortion::radtan) parameters.coefficients = {-0.25, 0.06, 0.001, -0.0005};
  if (distortion == Distortion::equidistant) {
    parameters.fu_px = parameters.fv_px = 120;
    parameters.coefficients = {-0.02, 0.003, 0, 0};
  }
  const auto camera = CameraModel::create(parameters);
  WAYMARK_CHECK(camera.has_value());
  return *camera;
}

}  // namespace waymark::testing
