#include "locd/pose/expected_windows.h"

#include <algorithm>
#include <cmath>

#include "core/marker/marker_outline.h"

namespace waymark {
namespace {

/// Below, a detector finds nothing (DetectorOptions); a little less, for predictions are not exact.
constexpr double kLeastSide_px = 10;
/// Least sine of the angle between a marker and the line of sight.
constexpr double kLeastSlant = 0.08;
/// How far off what was seen in the last image may be in the next.
constexpr double kSeenReach_px = 40;
constexpr double kSigmas = 3;
/// What is off beside the pose: the map, the lens, the rows' read-out.
constexpr double kLeastReach_px = 6;
/// Where windows are so much of an image, looking at all of it costs no more.
constexpr double kMostShare = 0.5;
constexpr std::size_t kMostWindows = 256;

double focal_px(const CameraModel& camera) {
  return std::max(camera.parameters().fu_px, camera.parameters().fv_px);
}

/// How far off (px) something at a distance may be seen from a pose that is predicted.
double reach_px(const CameraModel& camera, const Rigid3& rig_from_cam,
                const MotionPrediction& prediction, double distance_m) {
  const double position_m = std::sqrt(prediction.covariance.topLeftCorner<3, 3>().trace());
  const double turn_rad = std::sqrt(prediction.covariance.bottomRightCorner<3, 3>().trace());
  const double arm_m = rig_from_cam.translation.norm();
  const double angle_rad = turn_rad + (position_m + arm_m * turn_rad) / distance_m;
  return kLeastReach_px + kSigmas * focal_px(camera) * angle_rad;
}

bool holds(const ImageWindow& window, const Eigen::Vector2d& pixel) {
  return pixel.x() >= window.left_px && pixel.x() < window.left_px + window.width_px &&
         pixel.y() >= window.top_px && pixel.y() < window.top_px + window.height_px;
}

/// The window's part in the camera's image.
ImageWindow cut(const CameraModel& camera, const ImageWindow& window) {
  const CameraParameters& p = camera.parameters();
  return within(GrayView{nullptr, p.width_px, p.height_px, 0}, window);
}

}  // namespace

ExpectedWindows::ExpectedWindows(const Rig& rig, const MapIndex& map) : rig_(rig) {
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Rigid3& pose = map.marker(i).world_from_marker;
    places_.push_back({pose, pose.rotation * Eigen::Vector3d::UnitZ(), map.marker(i).size_m});
  }
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    windows_[c].reserve(2 * kMostWindows);
    seen_[c].reserve(kMostWindows);
  }
}

void ExpectedWindows::add_expected(const RigCamera& camera, const Rigid3& cam_from_world,
                                   const Place& place, const MotionPrediction& prediction,
                                   std::vector<ImageWindow>& windows) const {
  const Rigid3 cam_from_marker = cam_from_world * place.world_from_marker;
  ExpectedMarker expected;
  expected.reach_px =
      reach_px(camera.model, camera.rig_from_cam, prediction, cam_from_marker.translation.norm());
  const auto x_in_marker = marker_corners(place.size_m);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = camera.model.project(cam_from_marker * x_in_marker[i]);
    if (!pixel) return;
    expected.corners[i] = *pixel;
  }
  const ImageWindow window = cut(camera.model, window_of(expected));
  if (window.area_px2() > 0) windows.push_back(window);
}

/// What was seen where nothing is expected: unknown, moved or repeated markers.
void ExpectedWindows::add_seen(std::size_t camera) {
  std::vector<ImageWindow>& windows = windows_[camera];
  const std::size_t expected = windows.size();
  for (const ExpectedMarker& seen : seen_[camera]) {
    const Eigen::Vector2d middle = centre_of(seen.corners);
    const bool known =
        std::any_of(windows.begin(), windows.begin() + static_cast<std::ptrdiff_t>(expected),
                    [&](const ImageWindow& window) { return holds(window, middle); });
    if (!known) windows.push_back(cut(rig_.cameras[camera].model, window_of(seen)));
  }
}

void ExpectedWindows::predict_camera(std::size_t camera, const MotionPrediction& prediction) {
  const RigCamera& one = rig_.cameras[camera];
  const Rigid3 world_from_cam = prediction.world_from_rig * one.rig_from_cam;
  const Rigid3 cam_from_world = world_from_cam.inverse();
  std::vector<ImageWindow>& windows = windows_[camera];
  const double focal = focal_px(one.model);
  for (const Place& place : places_) {
    if (windows.size() > kMostWindows) break;
    const Eigen::Vector3d to_camera =
        world_from_cam.translation - place.world_from_marker.translation;
    const double distance2 = to_camera.squaredNorm();
    const double farthest = focal * place.size_m / kLeastSide_px;
    if (distance2 > farthest * farthest) continue;
    const double facing = place.normal.dot(to_camera);
    if (facing < 0 || facing * facing < kLeastSlant * kLeastSlant * distance2) continue;
    add_expected(one, cam_from_world, place, prediction, windows);
  }
  add_seen(camera);
  long area = 0;
  for (const ImageWindow& window : windows) area += window.area_px2();
  const CameraParameters& p = one.model.parameters();
  const double most = kMostShare * p.width_px * p.height_px;
  if (windows.size() > kMostWindows || static_cast<double>(area) > most) windows.clear();
}

void ExpectedWindows::predict(const std::optional<MotionPrediction>& prediction) {
  ++sets_;
  const std::size_t cameras = rig_.cameras.size();
  for (std::size_t c = 0; c < cameras; ++c) {
    windows_[c].clear();
    const int turn = sets_ + static_cast<int>(kTurns * c / cameras);
    if (prediction && turn % kTurns != 0) predict_camera(c, *prediction);
  }
}

void ExpectedWindows::remember(std::size_t camera, std::span<const Detection> detections) {
  seen_[camera].clear();
  for (const Detection& one : detections.first(std::min(detections.size(), kMostWindows))) {
    seen_[camera].push_back({one.marker, one.corners, kSeenReach_px});
  }
}

}  // namespace waymark
