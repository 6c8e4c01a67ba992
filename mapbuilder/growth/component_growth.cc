#include "mapbuilder/growth/component_growth.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/parallel.h"

namespace waymark {
namespace {

GrowthOptions growth_options(const BuildOptions& options) {
  GrowthOptions growth = options.growth;
  growth.rig_pose.loss = options.loss;
  growth.placement.loss = options.loss;
  growth.threads = options.threads;
  return growth;
}

std::vector<std::size_t> observations_of(const ObservationTable& table,
                                         std::span<const int> frame_sets) {
  std::vector<std::size_t> observations;
  for (const int frame_set : frame_sets) {
    const TableFrameSet& set = table.frame_sets[static_cast<std::size_t>(frame_set)];
    for (std::size_t i = 0; i < set.observation_count; ++i) {
      observations.push_back(set.first_observation + i);
    }
  }
  return observations;
}

}  // namespace

ComponentGrowth::ComponentGrowth(ObservationTable& table, const Component& component,
                                 const BuildOptions& options)
    : table_(table),
      component_(component),
      loss_(options.loss),
      threads_(effective_threads(options.threads)),
      noise_(options.noise),
      growth_(table, component, growth_options(options)),
      observations_(observations_of(table, component.frame_sets)),
      anchor_(choose_seed(table, component)) {
  set_whitening(table_, observations_, noise_);
}

void ComponentGrowth::grow(MapState& state, Progress& progress) {
  progress.begin("growing the map", component_.markers.size());
  growth_.grow(
      anchor_, state,
      [&](const std::vector<int>& markers, MapState& now) { adjust_fresh(markers, now); },
      [&](MapState& now) {
        // Sigmas as large as what growth has piled up: then the loss bends for outliers alone,
        // and a few steps lead to the optimum.
        adapt_noise(now);
        adjust(now);
        adapt_noise(now);
        if (growth_.reconsider(now) > 0) adjust(now);
      },
      [&](std::size_t placed, std::size_t localized) {
        progress.update(placed, fmt::format("{} of {} frame sets localized", localized,
                                            component_.frame_sets.size()));
      });
  progress.end();
}

void ComponentGrowth::adjust(MapState& state) const {
  adjust_jointly(table_, observations_, {{anchor_}, {}}, {loss_, 10, 1e-3, 1e-6, threads_, {}},
                 state);
  follow(state);
}

void ComponentGrowth::adjust_fresh(const std::vector<int>& markers, MapState& state) const {
  HeldPoses held{{anchor_}, std::vector<char>(table_.markers.size(), 1)};
  std::set<int> sets;
  for (const int marker : markers) {
    held.markers[static_cast<std::size_t>(marker)] = 0;
    for (const std::size_t index :
         table_.observations_of_marker[static_cast<std::size_t>(marker)]) {
      sets.insert(table_.observations[index].frame_set);
    }
  }
  const std::vector<int> frame_sets(sets.begin(), sets.end());
  adjust_jointly(table_, observations_of(table_, frame_sets), held,
                 {loss_, 6, 1e-2, 1e-6, threads_, {}}, state);
}

double ComponentGrowth::adapt_noise(ObservationTable& table, const MapState& state,
                                    NoiseModel& noise) const {
  std::vector<std::size_t> posed;
  std::set<int> sets;
  std::set<int> markers;
  for (const std::size_t index : observations_) {
    const TableObservation& o = table.observations[index];
    if (!state.posed(o)) continue;
    posed.push_back(index);
    sets.insert(o.frame_set);
    markers.insert(o.marker);
  }
  // Fewer residuals than that say nothing about their own size.
  constexpr double kMostParametersPerResidual = 0.8;
  const double share = 6.0 * static_cast<double>(sets.size() + markers.size()) /
                       (8.0 * static_cast<double>(std::max<std::size_t>(1, posed.size())));
  if (share > kMostParametersPerResidual) return 0.0;
  const double before = noise.model_sigma_px;
  const bool one_camera = std::all_of(sets.begin(), sets.end(), [&](int frame_set) {
    const int rig = table.frame_sets[static_cast<std::size_t>(frame_set)].rig;
    return table.rigs[static_cast<std::size_t>(rig)].cameras.size() == 1;
  });
  noise.model_sigma_px = std::min(estimate_model_sigma_px(table, state, posed, noise, share),
                                  one_camera ? kLargestModelSigmaOfOneCamera : kLargestModelSigma);
  set_whitening(table, observations_, noise);
  return std::abs(noise.model_sigma_px / before - 1.0);
}

}  // namespace waymark
