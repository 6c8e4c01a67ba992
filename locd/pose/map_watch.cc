#include "locd/pose/map_watch.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace waymark {
namespace {

/// Mean residual (sigmas², 8 freedoms) of a marker that is where the map says.
constexpr double kInPlace = 12;
/// Sets in its place that are remembered.
constexpr int kSetsInPlace = 5;
/// What is nearer is linear enough for the error model.
constexpr double kFar_m = 0.25;
constexpr double kFar_rad = 0.2;

}  // namespace

Status MapWatchOptions::check() const {
  return RangeCheck()
      .field("min_other_markers", min_other_markers, {2, 20})
      .field("sets_elsewhere", sets_elsewhere, {2, 100})
      .field("sets_back", sets_back, {2, 1000})
      .field("sets_unknown", sets_unknown, {2, 1000})
      .field("unknown_memory in s", in_us(unknown_memory) / 1e6, {1, 3600})
      .field("unknown_gone in s", in_us(unknown_gone) / 1e6, {60, 86'400})
      .status();
}

MapWatch::MapWatch(MapIndex& map, const RigPoseSolver& solver, const MapWatchOptions& options)
    : map_(map), solver_(solver), options_(options), records_(map.size()) {
  WAYMARK_CHECK(options.check().has_value());
  unknown_.reserve(kMostUnknown);
  seen_.reserve(kMaxObservations);
}

void MapWatch::update(Stamp stamp, std::span<const SetObservation> observations,
                      const PoseSolution& solution, CameraMask trusted_cameras,
                      std::vector<Alert>& alerts) {
  if (solution.ambiguous || solution.inlier_markers < 2 * solution.outlier_markers) return;
  find_seen(observations, trusted_cameras);
  std::erase_if(seen_, [&](const Seen& seen) {
    const int others = solution.inlier_markers - (seen.inlier ? 1 : 0);
    const bool tells = seen.observations > 0 && others >= options_.min_other_markers;
    records_[seen.map_index].seen = -1;
    return !tells;
  });
  for (const Seen& seen : seen_) {
    count(seen, solution);
    judge(stamp, seen.map_index, alerts);
  }
}

/// The set's markers, each with what the trusted cameras see of it.
void MapWatch::find_seen(std::span<const SetObservation> observations, CameraMask trusted_cameras) {
  seen_.clear();
  for (const SetObservation& o : observations) {
    Record& record = records_[o.map_index];
    if (record.seen < 0) {
      record.seen = static_cast<int>(seen_.size());
      seen_.emplace_back().map_index = o.map_index;
    }
    Seen& seen = seen_[static_cast<std::size_t>(record.seen)];
    seen.inlier = seen.inlier || o.inlier;
    const auto camera = static_cast<std::size_t>(o.observation.camera);
    if ((trusted_cameras & camera_bit(camera)) == 0) continue;
    ++seen.observations;
    seen.fitting += o.sigmas_squared <= kInlierSigmas2 ? 1 : 0;
    if (seen.largest == nullptr || area_px2(o.detected_px) > area_px2(seen.largest->detected_px)) {
      seen.largest = &o;
    }
  }
}

/// Counts what the set tells of where the marker hangs: nothing, where cameras contradict one
/// another.
void MapWatch::count(const Seen& seen, const PoseSolution& solution) {
  Record& record = records_[seen.map_index];
  if (seen.fitting == seen.observations) {
    const int most = map_.quarantined(seen.map_index) ? options_.sets_back : kSetsInPlace;
    record.sets_in_place = std::min(record.sets_in_place + 1, most);
    record.misfit += (seen.largest->sigmas_squared - record.misfit) / record.sets_in_place;
    record.sets_elsewhere = std::max(record.sets_elsewhere - 1, 0);
  } else if (seen.fitting == 0) {
    record.sets_in_place = std::max(0, record.sets_in_place - 1);
    look_elsewhere(*seen.largest, solution, record);
  }
}

void MapWatch::judge(Stamp stamp, std::size_t map_index, std::vector<Alert>& alerts) {
  const Record& record = records_[map_index];
  if (map_.quarantined(map_index) && record.sets_in_place >= options_.sets_back &&
      record.misfit < kInPlace) {
    release(stamp, map_index, alerts);
    return;
  }
  if (map_.quarantined(map_index) || record.sets_elsewhere < options_.sets_elsewhere ||
      record.sets_in_place > 0) {
    return;
  }
  const Vector6d offset = record.elsewhere.minus(map_.marker(map_index).world_from_marker);
  const bool far = offset.head<3>().norm() > kFar_m || offset.tail<3>().norm() > kFar_rad;
  if (far) quarantine(stamp, map_index, offset, alerts);
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

void MapWatch::quarantine(Stamp stamp, std::size_t map_index, const Vector6d& offset,
                          std::vector<Alert>& alerts) {
  Record& record = records_[map_index];
  record = {};
  record.offset = offset;
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

void MapWatch::quarantine_riding(Stamp stamp, std::size_t map_index, std::vector<Alert>& alerts) {
  Alert alert;
  alert.stamp = stamp;
  alert.marker = map_.marker(map_index).id;
  if (map_.quarantined(map_index)) {
    // What was said of it before is over: it hangs nowhere.
    alert.kind = records_[map_index].kind;
    if (alert.kind == AlertKind::marker_riding) return;
    alert.raised = false;
    alerts.push_back(alert);
  }
  records_[map_index] = {};
  records_[map_index].kind = alert.kind = AlertKind::marker_riding;
  map_.set_quarantined(map_index, true);
  changed_ = true;
  alert.raised = true;
  alerts.push_back(alert);
}

void MapWatch::release(Stamp stamp, std::size_t map_index, std::vector<Alert>& alerts) {
  Alert alert;
  alert.kind = records_[map_index].kind;
  records_[map_index] = {};
  map_.set_quarantined(map_index, false);
  changed_ = true;
  alert.raised = false;
  alert.stamp = stamp;
  alert.marker = map_.marker(map_index).id;
  alert.offset_m = 0;
  alert.offset_rad = 0;
  alerts.push_back(alert);
}

bool MapWatch::release(Stamp stamp, const MarkerId& marker, std::vector<Alert>& alerts) {
  if (const auto map_index = map_.find(marker)) {
    const bool quarantined = map_.quarantined(*map_index);
    if (quarantined) release(stamp, *map_index, alerts);
    return quarantined;
  }
  const auto named = std::find_if(unknown_.begin(), unknown_.end(), [&](const Unknown& unknown) {
    return unknown.marker == marker && unknown.named;
  });
  if (named == unknown_.end()) return false;
  *named = {marker, 0, false, {}};
  tell_unknown(stamp, marker, false, alerts);
  return true;
}

void MapWatch::look_at_fit(Stamp stamp, int fitting, int others, std::vector<Alert>& alerts) {
  constexpr int kFewest = 4;
  constexpr double kMemory = 1.0 / 30;
  constexpr double kWrong = 0.1;
  constexpr double kRight = 0.5;
  if (fitting + others < kFewest) return;
  const bool fits = fitting > others && fitting > 2;
  fitting_share_ += kMemory * ((fits ? 1.0 : 0.0) - fitting_share_);
  const bool wrong = fitting_share_ < (wrong_map_ ? kRight : kWrong);
  if (wrong == wrong_map_) return;
  wrong_map_ = wrong;
  Alert alert;
  alert.kind = AlertKind::map_wrong;
  alert.raised = wrong;
  alert.stamp = stamp;
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
      *oldest = {marker, 0, false, {}};
      known = oldest;
    } else {
      known = unknown_.insert(unknown_.end(), {marker, 0, false, {}});
    }
  }
  if (known->last == stamp) return;  // twice in one set
  if (known->last && !known->named) {
    const auto forgotten = (stamp - *known->last) / options_.unknown_memory;
    known->sets -= static_cast<int>(std::clamp<Stamp::rep>(forgotten, 0, known->sets));
  }
  known->last = stamp;
  ++known->sets;
  if (known->named || known->sets < options_.sets_unknown) return;
  known->named = true;
  tell_unknown(stamp, marker, true, alerts);
}

void MapWatch::forget_unknown(Stamp stamp, std::vector<Alert>& alerts) {
  for (Unknown& unknown : unknown_) {
    if (!unknown.named) continue;
    if (!unknown.last) unknown.last = stamp;
    if (stamp - *unknown.last < options_.unknown_gone) continue;
    unknown.named = false;
    unknown.sets = 0;
    tell_unknown(stamp, unknown.marker, false, alerts);
  }
}

void MapWatch::tell_unknown(Stamp stamp, const MarkerId& marker, bool raised,
                            std::vector<Alert>& alerts) {
  changed_ = true;
  Alert alert;
  alert.kind = AlertKind::marker_unknown;
  alert.raised = raised;
  alert.stamp = stamp;
  alert.marker = marker;
  alerts.push_back(alert);
}

void MapWatch::list_quarantine(std::vector<QuarantinedMarker>& list) {
  changed_ = false;
  list.clear();
  for (std::size_t i = 0; i < map_.size(); ++i) {
    if (!map_.quarantined(i)) continue;
    list.push_back({map_.marker(i).id, QuarantineState::moved, 0, records_[i].offset_m});
  }
  for (const Unknown& unknown : unknown_) {
    if (unknown.named) list.push_back({unknown.marker, QuarantineState::unknown, 0, 0});
  }
  std::sort(list.begin(), list.end(),
            [](const auto& a, const auto& b) { return a.marker < b.marker; });
}

void MapWatch::restore(std::span<const QuarantinedMarker> markers) {
  for (const QuarantinedMarker& marker : markers) {
    const auto index = map_.find(marker.marker);
    if (marker.state == QuarantineState::moved && index) {
      map_.set_quarantined(*index, true);
      records_[*index].offset_m = marker.offset_m;
    } else if (marker.state == QuarantineState::unknown && !index &&
               unknown_.size() < kMostUnknown) {
      unknown_.push_back({marker.marker, options_.sets_unknown, true, {}});
    }
  }
}

}  // namespace waymark
