#include "locd/pose/map_watch.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/geometry/symmetric_factor.h"
#include "locd/pose/whitened_residual.h"

namespace waymark {
namespace {

/// Residuals this large (sigmas²) say where a marker is not, hardly where it is.
constexpr double kLinear = 400.0;
/// As RobustPose tells inliers.
constexpr double kFits = 36.0;
/// Ids that the map lacks and that are remembered; of more, the ones not seen for longest go.
constexpr std::size_t kMostUnknown = 64;

/// What of the residuals' unit covariance is left when the pose has (inlier) or has not (outlier)
/// been fitted to them: 1 − J P Jᵀ, (1 + J P Jᵀ)⁻¹. As information on r it is cov⁻¹ after
/// leave-one-out, for the pose without it leaves (1 − J P Jᵀ)⁻¹.
Matrix8d left_out_information(const WhitenedResidual& w, const Matrix6d& pose_covariance,
                              bool inlier) {
  const Matrix8d of_pose = w.by_rig * pose_covariance * w.by_rig.transpose();
  if (inlier) return Matrix8d::Identity() - of_pose;
  return (Matrix8d::Identity() + of_pose).inverse();
}

}  // namespace

MapWatch::MapWatch(MapIndex& map, const RigPoseSolver& solver, const MapWatchOptions& options)
    : map_(map), solver_(solver), options_(options), records_(map.size()) {
  unknown_.reserve(kMostUnknown);
}

void MapWatch::update(Stamp stamp, std::span<const SetObservation> observations,
                      const PoseSolution& solution, CameraMask trusted_cameras,
                      std::vector<Alert>& alerts) {
  if (solution.ambiguous || solution.inlier_markers < 2 * solution.outlier_markers) return;
  for (const SetObservation& o : observations) {
    const int others = solution.inlier_markers - (o.inlier ? 1 : 0);
    const auto camera = static_cast<std::size_t>(o.observation.camera);
    if (others < options_.min_other_markers || (trusted_cameras & camera_bit(camera)) == 0)
      continue;
    Record& record = records_[o.map_index];
    if (o.sigmas_squared <= kLinear) sum_residuals(o, solution, record);
    if (o.sigmas_squared <= kFits) {
      record.sets_in_place = std::min(record.sets_in_place + 1, options_.sets_back);
      record.sets_elsewhere = std::max(record.sets_elsewhere - 1, 0);
    } else {
      record.sets_in_place = std::max(0, std::min(record.sets_in_place - 1, 5));
      look_elsewhere(o, solution, record);
    }
    Vector6d offset = Vector6d::Zero();
    const bool drift = drifted(record, map_.marker(o.map_index), offset);
    if (map_.quarantined(o.map_index)) {
      if (record.sets_in_place >= options_.sets_back && !drift) {
        welcome_back(stamp, o.map_index, alerts);
      }
    } else if (record.sets_elsewhere >= options_.sets_elsewhere && record.sets_in_place == 0) {
      name(stamp, o.map_index, record.elsewhere.minus(map_.marker(o.map_index).world_from_marker),
           alerts);
    } else if (drift) {
      name(stamp, o.map_index, offset, alerts);
    }
  }
}

void MapWatch::sum_residuals(const SetObservation& o, const PoseSolution& solution,
                             Record& record) const {
  const auto left = whitened_residual(o, map_, solver_, solution.world_from_rig);
  if (!left) return;
  const WhitenedResidual& w = *left;
  const Matrix8d information = left_out_information(w, solution.noise_covariance, o.inlier);
  const double keep = 1.0 - 1.0 / options_.memory_sets;
  record.information =
      keep * record.information + w.by_marker.transpose() * information * w.by_marker;
  // Of an inlier the residual left out is (1 − J P Jᵀ)⁻¹ r: its information takes that back.
  const Vector8d weighted = o.inlier ? w.residual : Vector8d(information * w.residual);
  record.evidence = keep * record.evidence - w.by_marker.transpose() * weighted;
}

void MapWatch::look_elsewhere(const SetObservation& o, const PoseSolution& solution,
                              Record& record) const {
  const auto camera = static_cast<std::size_t>(o.observation.camera);
  const Rigid3 world_from_cam = solution.world_from_rig * solver_.cam_from_rig(camera).inverse();
  const CameraModel& model = solver_.model(camera);
  if (record.sets_elsewhere > 0) {
    // The same other place, within the noise and a hundredth of the distance?
    const Rigid3 cam_from_marker = world_from_cam.inverse() * record.elsewhere;
    const auto residuals = corner_residuals(o.observation, model, cam_from_marker);
    if (residuals) {
      double worst_px = 0;
      for (const Eigen::Vector2d& r : *residuals) worst_px = std::max(worst_px, r.norm());
      const double side_px = std::sqrt(area_px2(o.detected_px));
      if (worst_px <= std::max(1.0, 0.1 * side_px)) {
        ++record.sets_elsewhere;
        return;
      }
    }
  }
  const auto ippe = solve_ippe(model, o.observation.corners_px, o.observation.size_m);
  if (!ippe) return;
  // Of the two solutions the one that is turned less against the map; a moved marker hardly tips.
  const Rigid3& mapped = map_.marker(o.map_index).world_from_marker;
  const Rigid3 first = world_from_cam * ippe->cam_from_marker[0];
  const Rigid3 second = world_from_cam * ippe->cam_from_marker[1];
  const bool second_nearer = ippe->rms_px[1] < 2 * ippe->rms_px[0] + 0.2 &&
                             angle_between_rad(second.rotation, mapped.rotation) <
                                 angle_between_rad(first.rotation, mapped.rotation);
  record.elsewhere = second_nearer ? second : first;
  record.sets_elsewhere = 1;
}

bool MapWatch::drifted(const Record& record, const MapMarker& marker, Vector6d& offset) const {
  // ± 1 m, ± 1 rad before anything was seen.
  const Matrix6d information = record.information + Matrix6d::Identity();
  const SymmetricFactor<6> factor(information);
  offset = factor.solve(record.evidence);
  // Quick exit for what is true of nearly every marker: no offset is significant even without map.
  if (offset.dot(record.evidence) < options_.naming_chi2) return false;
  const bool large = offset.head<3>().norm() >= options_.min_offset_m ||
                     offset.tail<3>().norm() >= options_.min_turn_rad;
  if (!large) return false;
  const Matrix6d covariance = factor.inverse() + marker.covariance;
  return offset.dot(SymmetricFactor<6>(covariance).solve(offset)) >= options_.naming_chi2;
}

void MapWatch::name(Stamp stamp, std::size_t map_index, const Vector6d& offset,
                    std::vector<Alert>& alerts) {
  Record& record = records_[map_index];
  record = {};
  record.offset_m = offset.head<3>().norm();
  map_.set_quarantined(map_index, true);
  changed_ = true;
  Alert alert;
  alert.kind = AlertKind::marker_moved;
  alert.stamp = stamp;
  alert.marker = map_.marker(map_index).id;
  alert.offset_m = record.offset_m;
  alert.offset_rad = offset.tail<3>().norm();
  alerts.push_back(alert);
}

void MapWatch::welcome_back(Stamp stamp, std::size_t map_index, std::vector<Alert>& alerts) {
  records_[map_index] = {};
  map_.set_quarantined(map_index, false);
  changed_ = true;
  Alert alert;
  alert.kind = AlertKind::marker_moved;
  alert.raised = false;
  alert.stamp = stamp;
  alert.marker = map_.marker(map_index).id;
  alert.offset_m = 0;
  alert.offset_rad = 0;
  alerts.push_back(alert);
}

void MapWatch::note_unknown(Stamp stamp, const MarkerId& marker, std::vector<Alert>& alerts) {
  auto known = std::find_if(unknown_.begin(), unknown_.end(),
                            [&](const Unknown& u) { return u.marker == marker; });
  if (known == unknown_.end()) {
    if (unknown_.size() == kMostUnknown) {
      const auto oldest =
          std::min_element(unknown_.begin(), unknown_.end(), [](const auto& a, const auto& b) {
            return a.named != b.named ? !a.named : a.last < b.last;
          });
      *oldest = {marker, 0, false, stamp};
      known = oldest;
    } else {
      known = unknown_.insert(unknown_.end(), {marker, 0, false, stamp});
    }
  }
  if (known->sets > 0 && known->last == stamp) return;  // twice in one set
  known->last = stamp;
  ++known->sets;
  if (known->named || known->sets < options_.sets_unknown) return;
  known->named = true;
  changed_ = true;
  Alert alert;
  alert.kind = AlertKind::marker_unknown;
  alert.stamp = stamp;
  alert.marker = marker;
  alerts.push_back(alert);
}

std::vector<QuarantinedMarker> MapWatch::quarantine() {
  changed_ = false;
  std::vector<QuarantinedMarker> list;
  for (std::size_t i = 0; i < map_.size(); ++i) {
    if (!map_.quarantined(i)) continue;
    list.push_back({map_.marker(i).id, QuarantineState::moved, 0, records_[i].offset_m});
  }
  for (const Unknown& unknown : unknown_) {
    if (unknown.named) list.push_back({unknown.marker, QuarantineState::unknown, 0, 0});
  }
  std::sort(list.begin(), list.end(),
            [](const auto& a, const auto& b) { return a.marker < b.marker; });
  return list;
}

void MapWatch::restore(std::span<const QuarantinedMarker> markers) {
  for (const QuarantinedMarker& marker : markers) {
    const auto index = map_.find(marker.marker);
    if (marker.state == QuarantineState::moved && index) {
      map_.set_quarantined(*index, true);
      records_[*index].offset_m = marker.offset_m;
    } else if (marker.state == QuarantineState::unknown && !index &&
               unknown_.size() < kMostUnknown) {
      unknown_.push_back({marker.marker, options_.sets_unknown, true, Stamp{0}});
    }
  }
}

}  // namespace waymark
