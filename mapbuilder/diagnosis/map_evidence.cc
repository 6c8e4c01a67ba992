#include "mapbuilder/diagnosis/map_evidence.h"

#include <cmath>
#include <limits>
#include <map>

namespace waymark {

MapEvidence::MapEvidence(ObservationTable& table, const BuiltSubMap& submap,
                         const BuildOptions& options)
    : table_(table),
      submap_(submap),
      options_(options),
      places_(table.markers.size()),
      rigs_(table.frame_sets.size()),
      accepted_in_set_(table.frame_sets.size(), 0),
      accepted_(table.observations.size(), 0) {
  NoiseModel noise = options.noise;
  noise.model_sigma_px = submap.model_sigma_px;
  set_whitening(table, noise);
  std::map<MarkerId, std::size_t> index_of;
  for (std::size_t m = 0; m < table.markers.size(); ++m) index_of.emplace(table.markers[m], m);
  for (const MapMarker& marker : submap.map.markers) {
    places_[index_of.at(marker.id)] = SizedPlace{marker.world_from_marker, marker.size_m};
  }
  for (const LocalizedFrameSet& set : submap.trajectory) {
    rigs_[static_cast<std::size_t>(set.frame_set)] = set.world_from_rig;
  }
  for (const ObservationResidual& residual : submap.residuals) {
    if (!residual.accepted) continue;
    accepted_[residual.observation] = 1;
    ++accepted_in_set_[static_cast<std::size_t>(
        table.observations[residual.observation].frame_set)];
  }
}

MarkerView MapEvidence::view_of(const TableObservation& o, std::size_t index) const {
  MarkerView view;
  view.observation = &o;
  view.camera = &camera_of(table_, o);
  view.world_from_cam = *rigs_[static_cast<std::size_t>(o.frame_set)] * view.camera->rig_from_cam;
  view.index = index;
  view.accepted = accepted_[index] != 0;
  const TableFrameSet& set = table_.frame_sets[static_cast<std::size_t>(o.frame_set)];
  for (std::size_t i = 0; i < set.observation_count; ++i) {
    const std::size_t other = set.first_observation + i;
    if (accepted_[other] != 0 && table_.observations[other].marker != o.marker) ++view.others;
  }
  return view;
}

std::vector<MarkerView> MapEvidence::views_of(int marker, int least_others) const {
  std::vector<MarkerView> views;
  const auto add = [&](const TableObservation& o, std::size_t index) {
    if (o.marker != marker || !rigs_[static_cast<std::size_t>(o.frame_set)]) return;
    const MarkerView view = view_of(o, index);
    if (view.others >= least_others) views.push_back(view);
  };
  for (const std::size_t index : table_.observations_of_marker[static_cast<std::size_t>(marker)]) {
    add(table_.observations[index], index);
  }
  return views;
}

std::vector<MarkerView> MapEvidence::independent_views_of(int marker, int least_others) const {
  std::vector<MarkerView> independent;
  for (MarkerView view : views_of(marker, least_others)) {
    const auto f = static_cast<std::size_t>(view.observation->frame_set);
    const TableFrameSet& set = table_.frame_sets[f];
    std::vector<FixedMarkerObservation> others;
    for (std::size_t i = 0; i < set.observation_count; ++i) {
      const std::size_t index = set.first_observation + i;
      const TableObservation& o = table_.observations[index];
      if (accepted_[index] == 0 || o.marker == marker) continue;
      others.push_back({&o, places_[static_cast<std::size_t>(o.marker)]->world_from_marker});
    }
    RigPoseOptions options = options_.growth.rig_pose;
    options.loss = options_.loss;
    const RigPoseSolver solver(table_.rigs[static_cast<std::size_t>(set.rig)], options);
    const auto found = solver.refine(others, *rigs_[f]);
    if (!found) continue;
    view.world_from_cam = found->pose * view.camera->rig_from_cam;
    independent.push_back(view);
  }
  return independent;
}

namespace {

/// The view's observation as one of a marker of the place's size.
MarkerObservation sized(const MarkerView& view, double size_m) {
  MarkerObservation observation = *view.observation;
  observation.size_m = size_m;
  return observation;
}

}  // namespace

double distance_px(const MarkerView& view, const SizedPlace& place) {
  const Rigid3 cam_from_marker = view.world_from_cam.inverse() * place.world_from_marker;
  const Eigen::Vector3d normal = cam_from_marker.rotation * Eigen::Vector3d::UnitZ();
  if (normal.dot(cam_from_marker.translation) >= 0) return std::numeric_limits<double>::infinity();
  const auto residuals =
      corner_residuals(sized(view, place.size_m), view.camera->model, cam_from_marker);
  if (!residuals) return std::numeric_limits<double>::infinity();
  double sum = 0;
  for (const Eigen::Vector2d& r : *residuals) sum += r.squaredNorm();
  return std::sqrt(0.25 * sum);
}

double misfit_sigmas2(const MarkerView& view, const SizedPlace& place) {
  return squared_residual(sized(view, place.size_m), view.camera->model,
                          view.world_from_cam.inverse() * place.world_from_marker);
}

double side_px(const MarkerView& view) { return std::sqrt(area_px2(view.observation->corners_px)); }

}  // namespace waymark
