#include "mapbuilder/diagnosis/map_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

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

MapEvidence::MapEvidence(ObservationTable& table, const ComponentFit& fit,
                         const BuildOptions& options, const std::vector<double>& stated_sizes_m)
    : table_(table),
      fit_(fit),
      options_(options),
      stated_sizes_m_(stated_sizes_m),
      markers_(fit.component.markers),
      places_(table.markers.size()),
      rigs_(table.frame_sets.size()),
      repeated_of_(table.markers.size()),
      repeated_in_(table.frame_sets.size()),
      accepted_(table.observations.size(), 1) {
  options_.growth.rig_pose.loss = options.loss;
  options_.growth.placement.loss = options.loss;
  NoiseModel noise = options.noise;
  noise.model_sigma_px = fit.model_sigma_px;
  set_whitening(table, noise);
  for (TableObservation& o : table.repeated) {
    resize(o, table.sizes_m[static_cast<std::size_t>(o.marker)]);
  }
  for (std::size_t i = 0; i < fit.component.markers.size(); ++i) {
    const auto m = static_cast<std::size_t>(fit.component.markers[i]);
    if (fit.world_from_marker[i]) {
      places_[m] = SizedPlace{*fit.world_from_marker[i], table.sizes_m[m]};
    }
  }
  for (std::size_t i = 0; i < fit.component.frame_sets.size(); ++i) {
    rigs_[static_cast<std::size_t>(fit.component.frame_sets[i])] = fit.world_from_rig[i];
  }
  for (const std::size_t index : fit.rejected) accepted_[index] = 0;
  for (std::size_t i = 0; i < table.repeated.size(); ++i) {
    const TableObservation& o = table.repeated[i];
    if (std::binary_search(frame_sets().begin(), frame_sets().end(), o.frame_set)) {
      markers_.push_back(o.marker);
    }
    const std::size_t index = table.observations.size() + i;
    repeated_of_[static_cast<std::size_t>(o.marker)].push_back(index);
    repeated_in_[static_cast<std::size_t>(o.frame_set)].push_back(index);
  }
  std::sort(markers_.begin(), markers_.end());
  markers_.erase(std::unique(markers_.begin(), markers_.end()), markers_.end());
}

const TableObservation& MapEvidence::observation(std::size_t index) const {
  return index < table_.observations.size() ? table_.observations[index]
                                            : table_.repeated[index - table_.observations.size()];
}

std::vector<std::size_t> MapEvidence::indices_in(int frame_set) const {
  const TableFrameSet& set = table_.frame_sets[static_cast<std::size_t>(frame_set)];
  std::vector<std::size_t> indices(set.observation_count);
  std::iota(indices.begin(), indices.end(), set.first_observation);
  const auto& repeated = repeated_in_[static_cast<std::size_t>(frame_set)];
  indices.insert(indices.end(), repeated.begin(), repeated.end());
  return indices;
}

std::vector<const TableObservation*> MapEvidence::seen_in(int frame_set) const {
  std::vector<const TableObservation*> seen;
  for (const std::size_t index : indices_in(frame_set)) seen.push_back(&observation(index));
  return seen;
}

std::vector<MarkerView> MapEvidence::views_in(int frame_set) const {
  std::vector<MarkerView> views;
  for (const std::size_t index : indices_in(frame_set)) {
    views.push_back(view_of(observation(index), index));
  }
  return views;
}

double MapEvidence::gate_sigmas2() const {
  return options_.gate.reject_sigmas * options_.gate.reject_sigmas;
}

const Rig& MapEvidence::rig_of(int frame_set) const {
  return fit_
      .rigs[static_cast<std::size_t>(table_.frame_sets[static_cast<std::size_t>(frame_set)].rig)];
}

RigPoseSolver MapEvidence::solver_for(int frame_set) const {
  return {rig_of(frame_set), options_.growth.rig_pose};
}

bool MapEvidence::is_accepted(std::size_t index) const {
  return index < accepted_.size() && accepted_[index] != 0 &&
         places_[static_cast<std::size_t>(table_.observations[index].marker)];
}

MarkerView MapEvidence::view_of(const TableObservation& o, std::size_t index) const {
  MarkerView view;
  view.observation = &o;
  view.camera = &rig_of(o.frame_set).cameras[static_cast<std::size_t>(o.camera)];
  view.world_from_cam =
      rigs_[static_cast<std::size_t>(o.frame_set)].value_or(Rigid3{}) * view.camera->rig_from_cam;
  view.index = index;
  view.accepted = is_accepted(index);
  const TableFrameSet& set = table_.frame_sets[static_cast<std::size_t>(o.frame_set)];
  for (std::size_t i = 0; i < set.observation_count; ++i) {
    const std::size_t other = set.first_observation + i;
    if (is_accepted(other) && table_.observations[other].marker != o.marker) ++view.others;
  }
  return view;
}

std::vector<MarkerView> MapEvidence::views_of(int marker, int least_others) const {
  std::vector<MarkerView> views;
  const auto m = static_cast<std::size_t>(marker);
  const auto add = [&](std::size_t index) {
    const TableObservation& o = observation(index);
    if (!rigs_[static_cast<std::size_t>(o.frame_set)]) return;
    const MarkerView view = view_of(o, index);
    if (view.others >= least_others) views.push_back(view);
  };
  for (const std::size_t index : table_.observations_of_marker[m]) add(index);
  for (const std::size_t index : repeated_of_[m]) add(index);
  return views;
}

std::vector<FixedMarkerObservation> MapEvidence::others_of(const MarkerView& view) const {
  std::vector<FixedMarkerObservation> others;
  const TableObservation& own = *view.observation;
  const TableFrameSet& set = table_.frame_sets[static_cast<std::size_t>(own.frame_set)];
  for (std::size_t i = 0; i < set.observation_count; ++i) {
    const std::size_t index = set.first_observation + i;
    const TableObservation& o = table_.observations[index];
    if (!is_accepted(index) || o.marker == own.marker) continue;
    others.push_back({&o, places_[static_cast<std::size_t>(o.marker)]->world_from_marker});
  }
  return others;
}

std::vector<MarkerView> MapEvidence::independent_views_of(int marker, int least_others) const {
  std::vector<MarkerView> independent;
  for (MarkerView view : views_of(marker, least_others)) {
    const int frame_set = view.observation->frame_set;
    const auto found = solver_for(frame_set).refine(others_of(view), *world_from_rig(frame_set));
    if (!found) continue;
    view.world_from_cam = found->pose * view.camera->rig_from_cam;
    independent.push_back(view);
  }
  return independent;
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
