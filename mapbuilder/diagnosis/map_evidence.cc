#include "mapbuilder/diagnosis/map_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace waymark {
namespace {

/// IPPE's solutions scale with the size.
void resize(MarkerObservation& observation, double size_m) {
  if (observation.ippe) {
    for (Rigid3& cam_from_marker : observation.ippe->cam_from_marker) {
      cam_from_marker.translation *= size_m / observation.size_m;
    }
  }
  observation.size_m = size_m;
}

}  // namespace

MapEvidence::MapEvidence(const PreparedObservations& prepared, const Estimate& estimate,
                         ComponentIndex component, const MapperOptions& options)
    : prepared_(prepared),
      estimate_(estimate),
      component_(prepared.selection().components()[component]),
      options_(effective(options)),
      markers_(component_.markers),
      places_(observations().markers.size()),
      rigs_(observations().frame_sets.size()),
      unused_of_(observations().markers.size()),
      unused_in_(observations().frame_sets.size()),
      accepted_(observations().all.size(), 0) {
  for (const MarkerIndex m : component_.markers) {
    if (estimate.world_from_marker[m]) {
      places_[m] = SizedPlace{*estimate.world_from_marker[m], size_m(m)};
    }
  }
  for (const FrameSetIndex f : component_.frame_sets) {
    const auto& rig = estimate.world_from_rig[f];
    if (rig && !rig->ambiguous) rigs_[f] = rig->best.pose;
  }
  const Selection& selection = prepared.selection();
  for (const ObservationIndex index : selection.used()) {
    if (estimate.accepts(index) && places_[selection[index].marker]) accepted_[index] = 1;
  }
  for (const ObservationIndex index : selection.unused()) {
    const Observation& o = selection[index];
    if (std::binary_search(frame_sets().begin(), frame_sets().end(), o.frame_set)) {
      markers_.push_back(o.marker);
    }
    unused_of_[o.marker].push_back(index);
    unused_in_[o.frame_set].push_back(index);
  }
  std::sort(markers_.begin(), markers_.end());
  markers_.erase(std::unique(markers_.begin(), markers_.end()), markers_.end());
}

std::vector<ObservationIndex> MapEvidence::indices_in(FrameSetIndex frame_set) const {
  const auto used = prepared_.selection().used_in(frame_set);
  std::vector<ObservationIndex> indices(used.begin(), used.end());
  const auto& unused = unused_in_[frame_set];
  indices.insert(indices.end(), unused.begin(), unused.end());
  return indices;
}

std::vector<const MarkerObservation*> MapEvidence::seen_in(FrameSetIndex frame_set) const {
  std::vector<const MarkerObservation*> seen;
  for (const ObservationIndex index : indices_in(frame_set)) seen.push_back(&prepared_[index]);
  return seen;
}

std::vector<MarkerView> MapEvidence::views_in(FrameSetIndex frame_set) const {
  std::vector<MarkerView> views;
  for (const ObservationIndex index : indices_in(frame_set)) views.push_back(view_of(index));
  return views;
}

double MapEvidence::gate_sigmas2() const {
  return options_.gate.reject_sigmas * options_.gate.reject_sigmas;
}

const Rig& MapEvidence::rig_of(FrameSetIndex frame_set) const {
  return estimate_.calibration.rigs[observations().frame_sets[frame_set].rig];
}

RigPoseSolver MapEvidence::solver_for(FrameSetIndex frame_set) const {
  return {rig_of(frame_set), options_.growth.rig_pose};
}

MarkerView MapEvidence::view_of(ObservationIndex index) const {
  const Observation& o = observations()[index];
  MarkerView view;
  view.index = index;
  view.frame_set = o.frame_set;
  view.marker = o.marker;
  view.observation = &prepared_[index];
  view.camera = &estimate_.calibration.camera(observations(), o);
  view.world_from_cam = rigs_[o.frame_set].value_or(Rigid3{}) * view.camera->rig_from_cam;
  view.accepted = accepted_[index] != 0;
  for (const ObservationIndex other : prepared_.selection().used_in(o.frame_set)) {
    if (accepted_[other] != 0 && observations()[other].marker != o.marker) ++view.others;
  }
  return view;
}

std::vector<MarkerView> MapEvidence::views_of(MarkerIndex marker, int least_others) const {
  std::vector<MarkerView> views;
  const auto add = [&](ObservationIndex index) {
    if (!rigs_[observations()[index].frame_set]) return;
    const MarkerView view = view_of(index);
    if (view.others >= least_others) views.push_back(view);
  };
  for (const ObservationIndex index : prepared_.selection().used_of(marker)) add(index);
  for (const ObservationIndex index : unused_of_[marker]) add(index);
  return views;
}

std::vector<FixedMarkerObservation> MapEvidence::others_of(const MarkerView& view) const {
  std::vector<FixedMarkerObservation> others;
  for (const ObservationIndex index : prepared_.selection().used_in(view.frame_set)) {
    const MarkerIndex marker = observations()[index].marker;
    if (accepted_[index] == 0 || marker == view.marker) continue;
    others.push_back({&prepared_[index], places_[marker]->world_from_marker});
  }
  return others;
}

std::vector<MarkerView> MapEvidence::independent_views_of(MarkerIndex marker,
                                                          int least_others) const {
  std::vector<MarkerView> independent;
  for (MarkerView view : views_of(marker, least_others)) {
    const auto found =
        solver_for(view.frame_set).refine(others_of(view), *world_from_rig(view.frame_set));
    if (!found) continue;
    view.world_from_cam = found->pose * view.camera->rig_from_cam;
    independent.push_back(view);
  }
  return independent;
}

std::vector<MarkerView> thinned(std::vector<MarkerView> views, std::size_t most) {
  if (views.size() <= most) return views;
  std::vector<MarkerView> kept;
  for (std::size_t i = 0; i < most; ++i) kept.push_back(views[i * views.size() / most]);
  return kept;
}

MarkerObservation sized_as(const MarkerView& view, double size_m) {
  MarkerObservation observation = *view.observation;
  resize(observation, size_m);
  return observation;
}

double distance_px(const MarkerView& view, const SizedPlace& place) {
  const Rigid3 cam_from_marker = view.world_from_cam.inverse() * place.world_from_marker;
  const Eigen::Vector3d normal = cam_from_marker.rotation * Eigen::Vector3d::UnitZ();
  if (normal.dot(cam_from_marker.translation) >= 0) return std::numeric_limits<double>::infinity();
  const auto residuals =
      corner_residuals(sized_as(view, place.size_m), view.camera->model, cam_from_marker);
  if (!residuals) return std::numeric_limits<double>::infinity();
  double sum = 0;
  for (const Eigen::Vector2d& r : *residuals) sum += r.squaredNorm();
  return std::sqrt(0.25 * sum);
}

double misfit_sigmas2(const MarkerView& view, const SizedPlace& place) {
  return squared_residual(sized_as(view, place.size_m), view.camera->model,
                          view.world_from_cam.inverse() * place.world_from_marker);
}

double side_px(const MarkerView& view) { return std::sqrt(area_px2(view.observation->corners_px)); }

}  // namespace waymark
