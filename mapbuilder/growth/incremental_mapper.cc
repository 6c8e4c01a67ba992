#include "mapbuilder/growth/incremental_mapper.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "mapbuilder/growth/adjustment_stages.h"
#include "mapbuilder/growth/frame_set_localization.h"
#include "mapbuilder/observations/covisibility.h"

namespace waymark {
namespace {

/// A pose is replaced only by one that explains the data better by more than this (sigmas²):
/// anything less is rounding.
constexpr double kWorthChanging = 1.0;

/// Nothing is seeded: what adjusts and judges needs no solutions.
constexpr auto kNoIppe = PreparedObservations::Ippe::none;

std::vector<MarkerIndex> markers_of(std::span<const PlacedMarker> placed) {
  std::vector<MarkerIndex> markers;
  for (const PlacedMarker& one : placed) markers.push_back(one.marker);
  return markers;
}

std::size_t localized_count(const Component& component, const Estimate& estimate) {
  return static_cast<std::size_t>(
      std::count_if(component.frame_sets.begin(), component.frame_sets.end(),
                    [&](FrameSetIndex f) { return estimate.world_from_rig[f].has_value(); }));
}

std::size_t placed_count(const Component& component, const Estimate& estimate) {
  return static_cast<std::size_t>(
      std::count_if(component.markers.begin(), component.markers.end(),
                    [&](MarkerIndex m) { return estimate.world_from_marker[m].has_value(); }));
}

}  // namespace

IncrementalMapper::IncrementalMapper(const Selection& selection, const MapperOptions& options)
    : selection_(selection), options_(effective(options)) {
  WAYMARK_CHECK(options.check().has_value());
  for (const Component& component : selection.components()) {
    parts_.push_back({choose_seed(selection, component), selection.used_in(component.frame_sets)});
  }
}

const PreparedObservations& IncrementalMapper::prepared(const Estimate& estimate,
                                                        PreparedObservations::Ippe ippe) const {
  if (prepared_) {
    prepared_->update(estimate, ippe);
  } else {
    prepared_.emplace(selection_, estimate, options_.threads);
  }
  return *prepared_;
}

std::vector<ObservationIndex> IncrementalMapper::observations_of(
    std::span<const ComponentIndex> components) const {
  std::vector<ObservationIndex> all;
  for (const ComponentIndex c : components) {
    all.insert(all.end(), parts_[c].observations.begin(), parts_[c].observations.end());
  }
  return all;
}

std::vector<FrameSetIndex> IncrementalMapper::frame_sets_that_see(
    std::span<const MarkerIndex> markers) const {
  std::set<FrameSetIndex> frame_sets;
  for (const MarkerIndex marker : markers) {
    for (const ObservationIndex index : selection_.used_of(marker)) {
      frame_sets.insert(selection_[index].frame_set);
    }
  }
  return {frame_sets.begin(), frame_sets.end()};
}

bool IncrementalMapper::differ(const Rigid3& a, const Rigid3& b) const {
  return angle_between_rad(a.rotation, b.rotation) > options_.growth.placement.distinct_rad ||
         (a.translation - b.translation).norm() > options_.growth.placement.distinct_m;
}

Estimate IncrementalMapper::seed(ComponentIndex component, Estimate estimate) const {
  estimate.world_from_rig[seed_of(component)] = RigPoseEstimate{};
  return estimate;
}

Estimate IncrementalMapper::localize(std::span<const FrameSetIndex> frame_sets,
                                     Estimate estimate) const {
  const PreparedObservations& now = prepared(estimate);
  return waymark::localize(now, frame_sets, options_, std::move(estimate));
}

Estimate IncrementalMapper::place(ComponentIndex component, std::span<const PlacedMarker> markers,
                                  Estimate estimate) const {
  for (const PlacedMarker& placed : markers) {
    estimate.world_from_marker[placed.marker] = placed.world_from_marker;
  }
  estimate = localize(frame_sets_that_see(markers_of(markers)), std::move(estimate));
  return adjust_fresh(component, markers, std::move(estimate));
}

Estimate IncrementalMapper::adjust_fresh(ComponentIndex component,
                                         std::span<const PlacedMarker> markers,
                                         Estimate estimate) const {
  BundleProblem problem;
  problem.prepared = &prepared(estimate, kNoIppe);
  problem.loss = options_.loss;
  problem.constant.frame_sets = {seed_of(component)};
  problem.constant.markers.assign(estimate.world_from_marker.size(), 1);
  for (const PlacedMarker& placed : markers) problem.constant.markers[placed.marker] = 0;
  problem.observations = selection_.used_in(frame_sets_that_see(markers_of(markers)));
  // Converged or not: what is left over goes with the next adjustment.
  return waymark::adjust(problem, fresh_adjustment(options_), std::move(estimate)).estimate;
}

BundleSolution IncrementalMapper::adjust(const AdjustedSystem& system, const BundleOptions& options,
                                         Estimate estimate) const {
  BundleProblem problem;
  problem.prepared = &prepared(estimate, kNoIppe);
  problem.loss = options_.loss;
  problem.scope = system.scope;
  problem.observations = observations_of(system.components);
  for (const ComponentIndex c : system.components) {
    if (!system.scope.in_facility(component(c).markers.front())) {
      problem.constant.frame_sets.push_back(seed_of(c));
    }
  }
  BundleSolution solution = waymark::adjust(problem, options, std::move(estimate));
  for (const ComponentIndex c : system.components) {
    const auto left_out =
        unadjusted_frame_sets(selection_, component(c).frame_sets, solution.estimate);
    solution.estimate = localize(left_out, std::move(solution.estimate));
  }
  return solution;
}

Estimate IncrementalMapper::adjust_growing(ComponentIndex component, Estimate estimate) const {
  const AdjustedSystem alone{{component}, {}};
  const BundleOptions options = growth_adjustment(options_);
  // Sigmas as large as what growth has piled up: then the loss bends for outliers alone, and a few
  // steps lead near the optimum, converged or not.
  estimate = fit_noise(component, std::move(estimate)).estimate;
  estimate = adjust(alone, options, std::move(estimate)).estimate;
  estimate = fit_noise(component, std::move(estimate)).estimate;
  ReconsideredEstimate reconsidered = reconsider(component, std::move(estimate));
  if (reconsidered.moved == 0) return std::move(reconsidered.estimate);
  return adjust(alone, options, std::move(reconsidered.estimate)).estimate;
}

Estimate IncrementalMapper::grow(ComponentIndex index, Estimate estimate,
                                 Progress& progress) const {
  const Component& grown = component(index);
  progress.begin("growing the map", grown.markers.size());
  if (!estimate.world_from_rig[seed_of(index)]) estimate = seed(index, std::move(estimate));
  PlacementQueue queue(selection_, grown, seed_of(index), options_);
  for (const FrameSetIndex frame_set : grown.frame_sets) {
    if (estimate.world_from_rig[frame_set]) queue.take_pose_of(frame_set, estimate);
  }
  std::size_t placed = placed_count(grown, estimate);
  std::size_t adjusted_at = placed;
  for (;;) {
    const std::vector<PlacedMarker> next = queue.next(prepared(estimate), estimate);
    if (next.empty()) break;
    for (const PlacedMarker& one : next) queue.remove(one.marker);
    estimate = place(index, next, std::move(estimate));
    placed += next.size();
    if (static_cast<double>(placed) >=
        options_.growth.adjust_growth * static_cast<double>(adjusted_at) + 2.0) {
      estimate = adjust_growing(index, std::move(estimate));
      adjusted_at = placed;
      if (gives_up(index, estimate)) break;
    }
    for (const FrameSetIndex frame_set : frame_sets_that_see(markers_of(next))) {
      if (estimate.world_from_rig[frame_set]) queue.take_pose_of(frame_set, estimate);
    }
    progress.update(placed, fmt::format("{} of {} frame sets localized",
                                        localized_count(grown, estimate), grown.frame_sets.size()));
  }
  progress.end();
  return estimate;
}

bool IncrementalMapper::gives_up(ComponentIndex index, const Estimate& estimate) const {
  // Fewer may hang together by a wrong id or two.
  constexpr std::size_t kFewest = 10;
  const double sigma_px = estimate.components[index].noise.model_sigma_px;
  if (sigma_px <= options_.growth.give_up_sigma_px) return false;
  return placed_count(component(index), estimate) >= kFewest;
}

ReconsideredEstimate IncrementalMapper::reconsider(ComponentIndex index, Estimate estimate) const {
  ReconsideredEstimate sets = reconsider_frame_sets(component(index), std::move(estimate));
  ReconsideredEstimate all = reconsider_markers(component(index), std::move(sets.estimate));
  all.moved += sets.moved;
  return all;
}

ReconsideredEstimate IncrementalMapper::reconsider_frame_sets(const Component& component,
                                                              Estimate estimate) const {
  std::vector<FrameSetIndex> localized;
  for (const FrameSetIndex f : component.frame_sets) {
    if (estimate.world_from_rig[f]) localized.push_back(f);
  }
  const auto fresh = solve_frame_sets(prepared(estimate), estimate, localized, options_);
  std::size_t moved = 0;
  for (std::size_t i = 0; i < localized.size(); ++i) {
    if (!fresh[i]) continue;
    auto& rig = estimate.world_from_rig[localized[i]];
    const Rigid3 adjusted = rig->best.pose;
    rig = fresh[i];
    if (differ(fresh[i]->best.pose, adjusted)) {
      ++moved;
    } else {
      // The jointly adjusted pose stays, with the fresh verdict on ambiguity.
      rig->best.pose = adjusted;
    }
  }
  return {std::move(estimate), moved};
}

ReconsideredEstimate IncrementalMapper::reconsider_markers(const Component& component,
                                                           Estimate estimate) const {
  std::vector<MarkerIndex> markers;
  for (const MarkerIndex m : component.markers) {
    if (estimate.world_from_marker[m]) markers.push_back(m);
  }
  const FrameSetFilter every = [](FrameSetIndex) { return true; };
  const PreparedObservations& now = prepared(estimate);
  const PlacementOptions& placement = options_.growth.placement;
  std::vector<std::optional<Rigid3>> replacement(markers.size());
  const auto most = static_cast<std::size_t>(options_.growth.max_placement_views);
  parallel_for(markers.size(), options_.threads, [&](std::size_t i) {
    const auto views = placement_views(now, estimate, markers[i], most, every);
    if (views.empty()) return;
    const auto found = place_marker(views, placement);
    const Rigid3& current = *estimate.world_from_marker[markers[i]];
    if (!found || !differ(found->best.pose, current)) return;
    const auto all_views =
        placement_views(now, estimate, markers[i], selection_.used().size(), every);
    if (placement_score(all_views, found->best.pose, placement) <
        placement_score(all_views, current, placement) - kWorthChanging) {
      replacement[i] = found->best.pose;
    }
  });
  std::vector<MarkerIndex> moved;
  for (std::size_t i = 0; i < markers.size(); ++i) {
    if (!replacement[i]) continue;
    estimate.world_from_marker[markers[i]] = replacement[i];
    moved.push_back(markers[i]);
  }
  if (moved.empty()) return {std::move(estimate), 0};
  return {localize(frame_sets_that_see(moved), std::move(estimate)), moved.size()};
}

NoiseFittedEstimate IncrementalMapper::fit_noise(ComponentIndex component,
                                                 Estimate estimate) const {
  const Observations& all = selection_.observations();
  std::vector<ObservationIndex> posed;
  std::set<FrameSetIndex> sets;
  std::set<MarkerIndex> markers;
  for (const ObservationIndex index : parts_[component].observations) {
    if (!estimate.posed(all[index])) continue;
    posed.push_back(index);
    sets.insert(all[index].frame_set);
    markers.insert(all[index].marker);
  }
  // Fewer residuals than that say nothing about their own size.
  constexpr double kMostParametersPerResidual = 0.8;
  const double share = 6.0 * static_cast<double>(sets.size() + markers.size()) /
                       (8.0 * static_cast<double>(std::max<std::size_t>(1, posed.size())));
  if (share > kMostParametersPerResidual) return {std::move(estimate), 0.0};
  NoiseModel& noise = estimate.components[component].noise;
  const double before = noise.model_sigma_px;
  const bool one_camera = std::all_of(sets.begin(), sets.end(), [&](FrameSetIndex f) {
    return all.rigs[all.frame_sets[f].rig].cameras.size() == 1;
  });
  noise.model_sigma_px =
      std::min(estimate_model_sigma_px(prepared(estimate, kNoIppe), estimate, posed, noise, share),
               one_camera ? kLargestModelSigmaOfOneCamera : kLargestModelSigma);
  const double change = std::abs(noise.model_sigma_px / before - 1.0);
  return {std::move(estimate), change};
}

GatedEstimate IncrementalMapper::gate(std::span<const ComponentIndex> components,
                                      Estimate estimate) const {
  const PreparedObservations& now = prepared(estimate, kNoIppe);
  return gate_outliers(now, observations_of(components), options_.gate, std::move(estimate));
}

}  // namespace waymark
