#include "locd/publish/messages.h"

#include <sys/random.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "core/geometry/degrees.h"
#include "locd/pose/pose_gate.h"
#include "locd/publish/status_text.h"

namespace waymark {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// The message's constants are those of the estimate.
static_assert(pose_t::OK == static_cast<int>(PoseStatus::ok));
static_assert(pose_t::DEGRADED == static_cast<int>(PoseStatus::degraded));
static_assert(pose_t::AMBIGUOUS == static_cast<int>(PoseStatus::ambiguous));
static_assert(pose_t::LOST == static_cast<int>(PoseStatus::lost));
static_assert(pose_t::NO_FRAMES == bit(PoseReason::no_frames));
static_assert(pose_t::NO_MAP == bit(PoseReason::no_map));
static_assert(pose_t::NO_MARKERS == bit(PoseReason::no_markers));
static_assert(pose_t::NO_SOLUTION == bit(PoseReason::no_solution));
static_assert(pose_t::TWO_POSES == bit(PoseReason::ambiguous));
static_assert(pose_t::SIGMA == bit(PoseReason::sigma));
static_assert(pose_t::FEW_MARKERS == bit(PoseReason::few_markers));
static_assert(pose_t::JUMP == bit(PoseReason::jump));
static_assert(pose_t::CAMERA_MISSING == bit(PoseReason::camera_missing));
static_assert(pose_t::NO_VELOCITY == bit(PoseReason::no_velocity));
static_assert(pose_t::SKEW == bit(PoseReason::skew));
static_assert(pose_t::UNSYNCED == bit(PoseReason::unsynced));
static_assert(pose_t::OUTLIERS == bit(PoseReason::outliers));
static_assert(pose_t::CAMERA_SUSPECT == bit(PoseReason::camera_suspect));
static_assert(pose_t::OVERLOAD == bit(PoseReason::overload));
static_assert(pose_t::MISFIT == bit(PoseReason::misfit));
static_assert(pose_t::WRONG_MAP == bit(PoseReason::wrong_map));
static_assert(pose_t::PROTECTION == bit(PoseReason::protection));

double microseconds(Stamp interval) { return static_cast<double>(interval.count()) * 1e-3; }

void fill_world_from_base(const PoseEstimate& estimate, const SessionFacts& session,
                          pose_t& message) {
  const Rigid3 world_from_base = estimate.world_from_rig * session.base_from_rig.inverse();
  const Matrix6d covariance =
      covariance_of_base(estimate.world_from_rig, estimate.covariance, session.base_from_rig);
  Eigen::Map<Eigen::Vector3d>(message.position) = world_from_base.translation;
  // q and −q are one rotation; a receiver that plots or differences them wants one of the two.
  Eigen::Vector4d wxyz(world_from_base.rotation.w(), world_from_base.rotation.x(),
                       world_from_base.rotation.y(), world_from_base.rotation.z());
  if (wxyz[0] < 0) wxyz = -wxyz;
  Eigen::Map<Eigen::Vector4d>(message.quaternion) = wxyz;
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(message.covariance) = covariance;
  message.rms_px = estimate.rms_px;
  const PoseSigmas sigmas = worst_sigmas(covariance);
  message.sigma_m = sigmas.position_m;
  message.sigma_deg = kDegreesPerRadian * sigmas.rotation_rad;
  message.yaw_deg = session.world_z_is_up ? yaw_deg(world_from_base) : kNaN;
}

void fill_protection(const Protection& protection, pose_t& message) {
  Eigen::Map<Eigen::Vector3d>(message.protection_m) = protection.axis_m;
  message.protection_horizontal_m = protection.horizontal_m;
  message.protection_deg = kDegreesPerRadian * protection.rotation_rad;
  message.protection_of_cameras = static_cast<std::int8_t>(protection.of_cameras);
}

/// Each camera's mid-exposure less that of the estimate; NaN where it gave no frame.
void fill_offsets(const PoseEstimate& estimate, std::vector<double>& offsets_us) {
  for (std::size_t c = 0; c < offsets_us.size(); ++c) {
    const bool delivered = (estimate.cameras_in_set & camera_bit(c)) != 0;
    offsets_us[c] = delivered ? microseconds(estimate.camera_offset[c]) : kNaN;
  }
}

/// Row by row what is on and above the diagonal of each corner's.
void fill_covariances(const std::optional<CornerCovariances>& stated, std::vector<float>& values) {
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto row = static_cast<Eigen::Index>(i / 2);
      const auto column = static_cast<Eigen::Index>((i + 1) / 2);
      values[3 * k + i] = static_cast<float>(stated ? (*stated)[k](row, column) : kNaN);
    }
  }
}

void fill_nothing_known(pose_t& message) {
  std::fill(std::begin(message.position), std::end(message.position), kNaN);
  std::fill(std::begin(message.quaternion), std::end(message.quaternion), kNaN);
  std::fill(std::begin(message.covariance), std::end(message.covariance), kNaN);
  message.rms_px = kNaN;
  message.yaw_deg = kNaN;
  message.sigma_m = message.sigma_deg = kNaN;
}

}  // namespace

std::string new_session_id() {
  std::uint64_t random = 0;
  // Cannot fall short: up to 256 bytes come whole once the kernel's generator is ready.
  while (::getrandom(&random, sizeof random, 0) != sizeof random) continue;
  return fmt::format("{:016x}", random);
}

pose_t make_pose_message(const SessionFacts& session) {
  pose_t message{};
  message.session_id = session.session_id;
  message.map_hash = session.map_hash;
  message.cameras = static_cast<std::int32_t>(session.cameras);
  message.camera_count = message.cameras;
  message.camera_offset_us.assign(session.cameras, kNaN);
  message.status_text.reserve(kMostStatusText);
  fill_nothing_known(message);
  fill_protection({Eigen::Vector3d::Constant(kNaN), kNaN, kNaN, false}, message);
  return message;
}

detections_t make_detections_message(const SessionFacts& session) {
  detections_t message{};
  message.session_id = session.session_id;
  message.rig = session.rig;
  message.camera_count = static_cast<std::int32_t>(session.cameras);
  message.camera_offset_us.assign(session.cameras, kNaN);
  // The arrays stay this long; count says how much of them is sent.
  message.camera.resize(kMaxObservations);
  message.family.resize(kMaxObservations, std::string(name_of(Family::tagstandard52h13)));
  message.marker_id.resize(kMaxObservations);
  message.corners_px.resize(kMaxObservations, std::vector<float>(8));
  message.covariances_px2.resize(kMaxObservations, std::vector<float>(12));
  message.verdict.resize(kMaxObservations);
  return message;
}

void fill_pose(const PoseEstimate& estimate, const SessionFacts& session, const ClockOffset& clock,
               Stamp published, pose_t& message) {
  message.utime = clock.utime_us(estimate.stamp);
  message.utime_published = clock.utime_us(published);
  message.status = static_cast<std::int8_t>(estimate.status);
  message.reasons = static_cast<std::int32_t>(estimate.reasons);
  write_status_text(estimate, message.status_text);
  message.resets = estimate.resets;
  message.cameras_used = std::popcount(estimate.cameras_used);
  message.markers_used = estimate.markers_used;
  message.outliers = estimate.outliers;
  message.max_skew_us = microseconds(estimate.max_skew);
  fill_offsets(estimate, message.camera_offset_us);
  message.map_hash = session.map_hash;
  if (estimate.has_pose()) {
    fill_world_from_base(estimate, session, message);
  } else {
    fill_nothing_known(message);
  }
  fill_protection(estimate.protection, message);
  message.x_m = message.position[0];
  message.y_m = message.position[1];
  message.z_m = message.position[2];
  message.latency_ms = static_cast<double>(message.utime_published - message.utime) * 1e-3;
}

void fill_detections(const PoseEstimate& estimate, const SessionFacts& session,
                     const ClockOffset& clock, detections_t& message) {
  message.utime = clock.utime_us(estimate.stamp);
  message.session_id = session.session_id;
  fill_offsets(estimate, message.camera_offset_us);
  const std::size_t count = std::min(estimate.observations.size(), kMaxObservations);
  message.count = static_cast<std::int32_t>(count);
  for (std::size_t i = 0; i < count; ++i) {
    const ObservedMarker& seen = estimate.observations[i];
    message.camera[i] = seen.camera;
    message.family[i] = name_of(seen.marker.family);
    message.marker_id[i] = seen.marker.number;
    message.verdict[i] = static_cast<std::int8_t>(seen.verdict);
    fill_covariances(seen.covariances, message.covariances_px2[i]);
    for (std::size_t k = 0; k < 4; ++k) {
      message.corners_px[i][2 * k] = static_cast<float>(seen.corners_px[k].x());
      message.corners_px[i][2 * k + 1] = static_cast<float>(seen.corners_px[k].y());
    }
  }
}

void fill_alert(const Alert& alert, const Rig& rig, const MapIdentity& map,
                const SessionFacts& session, const ClockOffset& clock, alert_t& message) {
  message.utime = clock.utime_us(alert.stamp);
  message.session_id = session.session_id;
  message.raised = static_cast<std::int8_t>(alert.raised);
  message.kind = name_of(alert.kind);
  message.subject = subject_of(alert, rig, map.several_families);
  message.text = alert_text(alert, rig, map.several_families);
  message.offset_m = alert.offset_m;
  message.offset_rad = alert.offset_rad;
  message.map_hash = map.map_hash;
}

Matrix6d covariance_of_base(const Rigid3& world_from_rig, const Matrix6d& covariance,
                            const Rigid3& base_from_rig) {
  const Eigen::Vector3d lever_in_world =
      world_from_rig.rotation * base_from_rig.inverse().translation;
  // t_base = t_rig + R t: δt_base = δt_rig + δφ × (R t), δφ the same.
  Matrix6d base_from_rig_errors = Matrix6d::Identity();
  base_from_rig_errors.topRightCorner<3, 3>() << 0, lever_in_world.z(), -lever_in_world.y(),
      -lever_in_world.z(), 0, lever_in_world.x(), lever_in_world.y(), -lever_in_world.x(), 0;
  return base_from_rig_errors * covariance * base_from_rig_errors.transpose();
}

double yaw_deg(const Rigid3& world_from_base) {
  const Eigen::Vector3d x_axis = world_from_base.rotation * Eigen::Vector3d::UnitX();
  const double yaw = std::atan2(x_axis.y(), x_axis.x()) * 180.0 / std::numbers::pi;
  return yaw <= -180.0 ? 180.0 : yaw;
}

}  // namespace waymark
