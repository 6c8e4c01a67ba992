#include "mapbuilder/growth/relocalization.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace waymark {
namespace {

/// Indices of the table's markers that the sub-map holds, with their poses and sizes put in place.
std::vector<char> place_map_markers(ObservationTable& table, const SubMap& submap,
                                    MapState& state) {
  std::map<MarkerId, const MapMarker*> mapped;
  for (const MapMarker& marker : submap.markers) mapped.emplace(marker.id, &marker);
  for (std::size_t m = 0; m < table.markers.size(); ++m) {
    const auto known = mapped.find(table.markers[m]);
    if (known != mapped.end()) state.world_from_marker[m] = known->second->world_from_marker;
  }
  std::vector<char> used(table.observations.size(), 0);
  for (std::size_t i = 0; i < table.observations.size(); ++i) {
    TableObservation& o = table.observations[i];
    const auto known = mapped.find(table.markers[static_cast<std::size_t>(o.marker)]);
    if (known == mapped.end()) continue;
    used[i] = 1;
    const double size_m = known->second->size_m;
    if (size_m != o.size_m) {
      o.size_m = size_m;
      o.ippe = solve_ippe(camera_of(table, o).model, o.corners_px, size_m);
    }
  }
  return used;
}

RelocalizedSubMap relocalize_in(ObservationTable& table, const SubMap& submap,
                                const BuildOptions& options) {
  RelocalizedSubMap result;
  MapState state(table);
  const std::vector<char> used = place_map_markers(table, submap, state);
  Component component;
  std::vector<std::size_t> observations;
  std::map<int, int> seen;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i] == 0) continue;
    observations.push_back(i);
    ++seen[table.observations[i].frame_set];
  }
  for (const auto& [frame_set, count] : seen) component.frame_sets.push_back(frame_set);

  GrowthOptions growth_options = options.growth;
  growth_options.rig_pose.loss = options.loss;
  growth_options.threads = options.threads;
  const Growth growth(table, component, growth_options);
  NoiseModel noise = options.noise;
  // The first round finds the poses; the second repeats it in sigmas that the residuals gave.
  for (int round = 0; round < 2; ++round) {
    set_whitening(table, noise);
    growth.localize_all(state);
    std::vector<std::size_t> posed;
    for (const std::size_t i : observations) {
      if (state.posed(table.observations[i])) posed.push_back(i);
    }
    const double share = 6.0 * static_cast<double>(seen.size()) /
                         (8.0 * static_cast<double>(std::max<std::size_t>(1, posed.size())));
    noise.model_sigma_px =
        estimate_model_sigma_px(table, state, posed, noise, std::min(share, 0.8));
    update_gate(table, posed, options.gate, state);
  }
  set_whitening(table, noise);
  growth.localize_all(state);
  result.model_sigma_px = noise.model_sigma_px;
  // A pose that only rejected observations speak for is none.
  std::map<int, int> accepted_in;
  for (const std::size_t i : observations)
    accepted_in[table.observations[i].frame_set] += state.accepted[i];
  for (const auto& [frame_set, accepted] : accepted_in) {
    if (accepted == 0) state.rigs[static_cast<std::size_t>(frame_set)].reset();
  }

  std::size_t inlier_corners = 0;
  std::size_t all_corners = 0;
  double inlier_sum = 0;
  double all_sum = 0;
  for (const std::size_t i : observations) {
    const TableObservation& o = table.observations[i];
    if (!state.posed(o)) continue;
    const auto residuals =
        corner_residuals(o, camera_of(table, o).model, cam_from_marker(table, state, o));
    ++result.observations;
    if (state.accepted[i] == 0 || !residuals) ++result.rejected;
    if (!residuals) continue;
    double sum = 0;
    for (const Eigen::Vector2d& r : *residuals) sum += r.squaredNorm();
    all_sum += sum;
    all_corners += 4;
    if (state.accepted[i] == 0) continue;
    inlier_sum += sum;
    inlier_corners += 4;
  }
  const auto rms = [](double sum, std::size_t corners) {
    return corners == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(corners));
  };
  result.rms_all_px = rms(all_sum, all_corners);
  result.rms_px = rms(inlier_sum, inlier_corners);
  for (const auto& [frame_set, count] : seen) {
    result.candidates += count >= 2 ? 1 : 0;
    const auto& rig = state.rigs[static_cast<std::size_t>(frame_set)];
    if (!rig) continue;
    if (rig->ambiguous) {
      result.ambiguous.push_back(frame_set);
    } else {
      result.localized += count >= 2 ? 1 : 0;
      result.trajectory.push_back({frame_set, rig->best.pose});
    }
  }
  return result;
}

}  // namespace

std::vector<RelocalizedSubMap> relocalize(ObservationTable& table, const MarkerMap& map,
                                          const BuildOptions& options, Progress& progress) {
  std::vector<RelocalizedSubMap> results;
  progress.begin("localizing", map.submaps.size());
  for (const SubMap& submap : map.submaps) {
    results.push_back(relocalize_in(table, submap, options));
    progress.update(results.size());
  }
  progress.end();
  return results;
}

}  // namespace waymark
