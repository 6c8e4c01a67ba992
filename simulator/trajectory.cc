#include "simulator/trajectory.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/check.h"

namespace waymark::simulator {
namespace {

/// Straight pieces per segment by which arc length is measured; a room's segment of 5 m gets 4 cm
/// pieces.
constexpr int kSamplesPerSegment = 128;

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// Four neighbouring way-points around a segment and the place within it.
struct SegmentPlace {
  std::array<std::size_t, 4> points;
  double t;  ///< 0…1 between points[1] and points[2]
};

SegmentPlace place_at(double parameter, std::size_t count) {
  const double periodic =
      parameter - std::floor(parameter / static_cast<double>(count)) * static_cast<double>(count);
  const auto segment = std::min(static_cast<std::size_t>(periodic), count - 1);
  return {{(segment + count - 1) % count, segment, (segment + 1) % count, (segment + 2) % count},
          periodic - static_cast<double>(segment)};
}

template <typename T>
T catmull_rom(const std::array<T, 4>& p, double t) {
  return T(p[1] + 0.5 * t * (p[2] - p[0]) + t * t * (p[0] - 2.5 * p[1] + 2.0 * p[2] - 0.5 * p[3]) +
           t * t * t * (1.5 * (p[1] - p[2]) + 0.5 * (p[3] - p[0])));
}

template <typename T>
T catmull_rom_slope(const std::array<T, 4>& p, double t) {
  return T(0.5 * (p[2] - p[0]) + 2 * t * (p[0] - 2.5 * p[1] + 2.0 * p[2] - 0.5 * p[3]) +
           3 * t * t * (1.5 * (p[1] - p[2]) + 0.5 * (p[3] - p[0])));
}

std::array<Eigen::Vector3d, 4> positions(const std::vector<Waypoint>& w, const SegmentPlace& s) {
  return {w[s.points[0]].at_m, w[s.points[1]].at_m, w[s.points[2]].at_m, w[s.points[3]].at_m};
}

/// The angles of four neighbours, unwrapped so that each turns the short way from the one before.
std::array<double, 4> unwrapped(std::array<double, 4> angles_deg) {
  for (std::size_t i = 1; i < 4; ++i) {
    angles_deg[i] = angles_deg[i - 1] + std::remainder(angles_deg[i] - angles_deg[i - 1], 360.0);
  }
  return angles_deg;
}

}  // namespace

Trajectory::Trajectory(const TrajectoryPlan& plan)
    : waypoints_(plan.waypoints), look_from_travel_(plan.look_from_travel) {
  WAYMARK_CHECK(waypoints_.size() >= 3);
  const std::size_t pieces = waypoints_.size() * kSamplesPerSegment;
  arc_m_.reserve(pieces + 1);
  arc_m_.push_back(0.0);
  Eigen::Vector3d before = waypoints_.front().at_m;
  for (std::size_t k = 1; k <= pieces; ++k) {
    const SegmentPlace place =
        place_at(static_cast<double>(k) / kSamplesPerSegment, waypoints_.size());
    const Eigen::Vector3d here = catmull_rom(positions(waypoints_, place), place.t);
    arc_m_.push_back(arc_m_.back() + (here - before).norm());
    before = here;
  }
}

double Trajectory::parameter_at(double arc_m) const {
  const double within = arc_m - std::floor(arc_m / length_m()) * length_m();
  const auto above = std::upper_bound(arc_m_.begin() + 1, arc_m_.end() - 1, within);
  const auto k = static_cast<double>(above - arc_m_.begin() - 1);
  const double piece_m = *above - *(above - 1);
  return (k + (piece_m > 0 ? (within - *(above - 1)) / piece_m : 0.0)) / kSamplesPerSegment;
}

Eigen::Vector3d Trajectory::position_m(double arc_m) const {
  const SegmentPlace place = place_at(parameter_at(arc_m), waypoints_.size());
  return catmull_rom(positions(waypoints_, place), place.t);
}

Rigid3 Trajectory::world_from_cam0(double arc_m) const {
  const SegmentPlace place = place_at(parameter_at(arc_m), waypoints_.size());
  const auto points = positions(waypoints_, place);
  std::array<double, 4> look_deg{};
  std::array<double, 4> pitch_deg{};
  for (std::size_t i = 0; i < 4; ++i) {
    look_deg[i] = waypoints_[place.points[i]].look_deg;
    pitch_deg[i] = waypoints_[place.points[i]].pitch_deg;
  }
  double yaw_rad = catmull_rom(unwrapped(look_deg), place.t) * kRadPerDeg;
  if (look_from_travel_) {
    const Eigen::Vector3d travel = catmull_rom_slope(points, place.t);
    yaw_rad += std::atan2(travel.y(), travel.x());
  }
  const double pitch_rad = catmull_rom(pitch_deg, place.t) * kRadPerDeg;
  const Eigen::Vector3d forward(std::cos(pitch_rad) * std::cos(yaw_rad),
                                std::cos(pitch_rad) * std::sin(yaw_rad), std::sin(pitch_rad));
  const Eigen::Vector3d right(std::sin(yaw_rad), -std::cos(yaw_rad), 0.0);
  Eigen::Matrix3d world_from_cam;
  world_from_cam << right, forward.cross(right), forward;
  return {Eigen::Quaterniond(world_from_cam).normalized(), catmull_rom(points, place.t)};
}

}  // namespace waymark::simulator
