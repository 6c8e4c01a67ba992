#include "mapbuilder/growth/growth.h"

#include <algorithm>
#include <set>

#include "core/base/parallel.h"

namespace waymark {
namespace {

/// A pose is replaced only by one that explains the data better by more than this (sigmas²):
/// anything less is rounding.
constexpr double kWorthChanging = 1.0;

/// One rig pose solver per rig of the table: a worker thread's tools.
std::vector<RigPoseSolver> solvers_for(const ObservationTable& table,
                                       const RigPoseOptions& options) {
  std::vector<RigPoseSolver> solvers;
  solvers.reserve(table.rigs.size());
  for (const Rig& rig : table.rigs) solvers.emplace_back(rig, options);
  return solvers;
}

}  // namespace

Growth::Growth(const ObservationTable& table, const Component& component,
               const GrowthOptions& options)
    : table_(table), component_(component), options_(options) {
  options_.threads = effective_threads(options.threads);
}

std::vector<FixedMarkerObservation> Growth::mapped_observations(const MapState& state,
                                                                int frame_set) const {
  const TableFrameSet& set = table_.frame_sets[static_cast<std::size_t>(frame_set)];
  const auto collect = [&](bool accepted_only) {
    std::vector<FixedMarkerObservation> observations;
    for (std::size_t i = 0; i < set.observation_count; ++i) {
      const std::size_t index = set.first_observation + i;
      const TableObservation& o = table_.observations[index];
      const auto& world_from_marker = state.world_from_marker[static_cast<std::size_t>(o.marker)];
      if (!world_from_marker || (accepted_only && state.accepted[index] == 0)) continue;
      observations.push_back({&o, *world_from_marker});
    }
    return observations;
  };
  auto observations = collect(true);
  return observations.empty() ? collect(false) : observations;
}

std::optional<RigPoseEstimate> Growth::solve_afresh(
    RigPoseSolver& solver, std::span<const FixedMarkerObservation> observations,
    const std::optional<RigPoseEstimate>& known) const {
  if (!known) return solver.solve(observations);
  const auto here = solver.refine(observations, known->best.pose);
  const double most = options_.explained_sigmas2 * static_cast<double>(observations.size());
  if (here && !known->ambiguous && here->cost <= most) {
    // Nothing is left to explain: no other pose can be better by more than this cost.
    RigPoseEstimate same = *known;
    same.best = *here;
    return same;
  }
  return solver.solve(observations, {&known->best.pose, 1});
}

bool Growth::differ(const Rigid3& a, const Rigid3& b) const {
  return angle_between_rad(a.rotation, b.rotation) > options_.placement.distinct_rad ||
         (a.translation - b.translation).norm() > options_.placement.distinct_m;
}

void Growth::localize(const std::vector<int>& frame_sets, MapState& state) const {
  std::vector<std::optional<RigPoseEstimate>> found(frame_sets.size());
  parallel_for_with(
      frame_sets.size(), options_.threads, [&] { return solvers_for(table_, options_.rig_pose); },
      [&](std::vector<RigPoseSolver>& solvers, std::size_t i) {
        const auto index = static_cast<std::size_t>(frame_sets[i]);
        const auto observations = mapped_observations(state, frame_sets[i]);
        if (observations.empty()) return;
        RigPoseSolver& solver = solvers[static_cast<std::size_t>(table_.frame_sets[index].rig)];
        found[i] = solve_afresh(solver, observations, state.rigs[index]);
      });
  for (std::size_t i = 0; i < frame_sets.size(); ++i) {
    state.rigs[static_cast<std::size_t>(frame_sets[i])] = found[i];
  }
}

void Growth::localize_all(MapState& state) const { localize(component_.frame_sets, state); }

void Growth::localize_unadjusted(MapState& state) const {
  std::vector<int> left_out;
  for (const int frame_set : component_.frame_sets) {
    const TableFrameSet& set = table_.frame_sets[static_cast<std::size_t>(frame_set)];
    int accepted = 0;
    for (std::size_t i = 0; i < set.observation_count; ++i) {
      const std::size_t index = set.first_observation + i;
      const TableObservation& o = table_.observations[index];
      accepted += state.accepted[index] != 0 && state.posed(o) ? 1 : 0;
    }
    if (accepted < 2) left_out.push_back(frame_set);
  }
  localize(left_out, state);
}

std::vector<PlacementView> Growth::placement_views(const MapState& state, int marker,
                                                   std::size_t most,
                                                   const FrameSetFilter& firm) const {
  const auto collect = [&](bool accepted_only) {
    std::vector<std::size_t> usable;
    for (const std::size_t index :
         table_.observations_of_marker[static_cast<std::size_t>(marker)]) {
      const TableObservation& o = table_.observations[index];
      if ((state.accepted[index] != 0 || !accepted_only) &&
          state.rigs[static_cast<std::size_t>(o.frame_set)] && firm(o.frame_set)) {
        usable.push_back(index);
      }
    }
    return usable;
  };
  // A marker between two places that it was seen at has no accepted view: it is placed anew by all.
  std::vector<std::size_t> usable = collect(true);
  if (usable.empty()) usable = collect(false);
  // Half of the views are the largest, for precision; half are spread over the smaller ones, for
  // variety. By size alone, so that neither stamps nor order decide.
  if (usable.size() > most) {
    std::stable_sort(usable.begin(), usable.end(), [&](std::size_t a, std::size_t b) {
      return area_px2(table_.observations[a].corners_px) >
             area_px2(table_.observations[b].corners_px);
    });
    const std::size_t largest = most / 2;
    const std::size_t spread = most - largest;
    for (std::size_t i = 0; i < spread; ++i) {
      usable[largest + i] = usable[largest + i * (usable.size() - largest) / spread];
    }
    usable.resize(most);
  }
  std::vector<PlacementView> views;
  views.reserve(usable.size());
  for (const std::size_t index : usable) {
    const TableObservation& o = table_.observations[index];
    const RigCamera& camera = camera_of(table_, o);
    const RigPoseEstimate& rig = *state.rigs[static_cast<std::size_t>(o.frame_set)];
    PlacementView view{&o, &camera.model, camera.rig_from_cam.inverse(), rig.best.pose,
                       std::nullopt};
    if (rig.ambiguous) view.other_world_from_rig = rig.runner_up->pose;
    views.push_back(view);
  }
  return views;
}

std::vector<std::optional<PlacementEstimate>> Growth::place(const std::vector<int>& markers,
                                                            const MapState& state,
                                                            const FrameSetFilter& firm) const {
  std::vector<std::optional<PlacementEstimate>> placed(markers.size());
  parallel_for(markers.size(), options_.threads, [&](std::size_t i) {
    const auto views = placement_views(state, markers[i], max_placement_views(), firm);
    if (!views.empty()) placed[i] = place_marker(views, options_.placement);
  });
  return placed;
}

std::vector<int> Growth::mapped_markers_per_frame_set(const MapState& state) const {
  std::vector<int> count(table_.frame_sets.size(), 0);
  for (const int frame_set : component_.frame_sets) {
    const TableFrameSet& set = table_.frame_sets[static_cast<std::size_t>(frame_set)];
    for (std::size_t i = 0; i < set.observation_count; ++i) {
      const TableObservation& o = table_.observations[set.first_observation + i];
      if (state.world_from_marker[static_cast<std::size_t>(o.marker)]) {
        ++count[static_cast<std::size_t>(frame_set)];
      }
    }
  }
  return count;
}

void Growth::grow(int seed, MapState& state, const AdjustFresh& adjust_fresh,
                  const AdjustJointly& adjust, const Report& report) {
  RigPoseEstimate origin;  // the seed's frame is the world
  state.rigs[static_cast<std::size_t>(seed)] = origin;

  // What rigs of a given firmness say of the markers that are not placed yet.
  struct Firmness {
    int mapped_markers = 0;
    std::set<int> dirty{};    // seen by a frame set whose pose is new
    std::set<int> waiting{};  // with an estimate
    std::vector<std::optional<PlacementEstimate>> estimate{};
  };
  std::vector<Firmness> levels;
  for (int mapped = options_.firm_markers; mapped >= 1; --mapped) {
    levels.push_back({mapped, {}, {}, {}});
    levels.back().estimate.resize(table_.markers.size());
  }
  const auto mark_markers_of = [&](int frame_set) {
    const TableFrameSet& set = table_.frame_sets[static_cast<std::size_t>(frame_set)];
    for (std::size_t i = 0; i < set.observation_count; ++i) {
      const int marker = table_.observations[set.first_observation + i].marker;
      if (state.world_from_marker[static_cast<std::size_t>(marker)]) continue;
      for (Firmness& level : levels) level.dirty.insert(marker);
    }
  };
  mark_markers_of(seed);

  // The clear markers of the firmest rigs that have any; without one, the clearest of all.
  const auto next_markers = [&]() -> std::vector<std::pair<int, Rigid3>> {
    std::vector<int> mapped = mapped_markers_per_frame_set(state);
    mapped[static_cast<std::size_t>(seed)] = options_.firm_markers;
    for (Firmness& level : levels) {
      const std::vector<int> to_place(level.dirty.begin(), level.dirty.end());
      level.dirty.clear();
      const auto estimates = place(to_place, state, [&](int frame_set) {
        return mapped[static_cast<std::size_t>(frame_set)] >= level.mapped_markers;
      });
      for (std::size_t i = 0; i < to_place.size(); ++i) {
        if (!estimates[i]) continue;
        level.estimate[static_cast<std::size_t>(to_place[i])] = estimates[i];
        level.waiting.insert(to_place[i]);
      }
      std::vector<std::pair<int, Rigid3>> clear;
      for (const int marker : level.waiting) {
        const PlacementEstimate& estimate = *level.estimate[static_cast<std::size_t>(marker)];
        if (estimate.gap >= options_.placement_gap) clear.emplace_back(marker, estimate.best.pose);
      }
      if (!clear.empty()) return clear;
    }
    int clearest = -1;
    const auto& estimate = levels.back().estimate;
    for (const int marker : levels.back().waiting) {
      if (clearest < 0 || estimate[static_cast<std::size_t>(marker)]->gap >
                              estimate[static_cast<std::size_t>(clearest)]->gap) {
        clearest = marker;
      }
    }
    if (clearest < 0) return {};
    return {{clearest, estimate[static_cast<std::size_t>(clearest)]->best.pose}};
  };

  std::size_t placed = 0;
  std::size_t localized = 1;
  std::size_t adjusted_at = 0;
  for (auto next = next_markers(); !next.empty(); next = next_markers()) {
    std::set<int> dirty_sets;
    std::vector<int> fresh;
    for (const auto& [marker, world_from_marker] : next) {
      fresh.push_back(marker);
      for (Firmness& level : levels) {
        level.waiting.erase(marker);
        level.dirty.erase(marker);
      }
      const auto m = static_cast<std::size_t>(marker);
      state.world_from_marker[m] = world_from_marker;
      ++placed;
      for (const std::size_t index : table_.observations_of_marker[m]) {
        dirty_sets.insert(table_.observations[index].frame_set);
      }
    }
    localize({dirty_sets.begin(), dirty_sets.end()}, state);
    adjust_fresh(fresh, state);
    const bool due = static_cast<double>(placed) >=
                     options_.adjust_growth * static_cast<double>(adjusted_at) + 2.0;
    if (due) {
      adjust(state);
      adjusted_at = placed;
    }
    for (const int frame_set : dirty_sets) {
      if (state.rigs[static_cast<std::size_t>(frame_set)]) mark_markers_of(frame_set);
    }
    localized = static_cast<std::size_t>(
        std::count_if(component_.frame_sets.begin(), component_.frame_sets.end(),
                      [&](int f) { return state.rigs[static_cast<std::size_t>(f)].has_value(); }));
    report(placed, localized);
  }
}

std::size_t Growth::reconsider(MapState& state) const {
  std::size_t changed = 0;

  std::vector<int> sets;
  for (const int f : component_.frame_sets) {
    if (state.rigs[static_cast<std::size_t>(f)]) sets.push_back(f);
  }
  std::vector<std::optional<RigPoseEstimate>> fresh(sets.size());
  parallel_for_with(
      sets.size(), options_.threads, [&] { return solvers_for(table_, options_.rig_pose); },
      [&](std::vector<RigPoseSolver>& solvers, std::size_t i) {
        const auto index = static_cast<std::size_t>(sets[i]);
        RigPoseSolver& solver = solvers[static_cast<std::size_t>(table_.frame_sets[index].rig)];
        const auto observations = mapped_observations(state, sets[i]);
        if (!observations.empty()) fresh[i] = solve_afresh(solver, observations, state.rigs[index]);
      });
  for (std::size_t i = 0; i < sets.size(); ++i) {
    if (!fresh[i]) continue;
    auto& rig = state.rigs[static_cast<std::size_t>(sets[i])];
    const Rigid3 adjusted = rig->best.pose;
    const bool moved = differ(fresh[i]->best.pose, adjusted);
    rig = fresh[i];
    if (moved) {
      ++changed;
    } else {
      // The jointly adjusted pose stays, with the fresh verdict on ambiguity.
      rig->best.pose = adjusted;
    }
  }

  std::vector<int> markers;
  for (const int m : component_.markers) {
    if (state.world_from_marker[static_cast<std::size_t>(m)]) markers.push_back(m);
  }
  const FrameSetFilter every = [](int /*frame_set*/) { return true; };
  std::vector<std::optional<Rigid3>> replacement(markers.size());
  parallel_for(markers.size(), options_.threads, [&](std::size_t i) {
    const auto views = placement_views(state, markers[i], max_placement_views(), every);
    if (views.empty()) return;
    const auto estimate = place_marker(views, options_.placement);
    const Rigid3& current = *state.world_from_marker[static_cast<std::size_t>(markers[i])];
    if (!estimate) return;
    if (!differ(estimate->best.pose, current)) return;
    const auto all_views = placement_views(state, markers[i], table_.observations.size(), every);
    const auto score = [&](const Rigid3& pose) {
      return placement_score(all_views, pose, options_.placement);
    };
    if (score(estimate->best.pose) < score(current) - kWorthChanging) {
      replacement[i] = estimate->best.pose;
    }
  });
  std::set<int> dirty_sets;
  for (std::size_t i = 0; i < markers.size(); ++i) {
    if (!replacement[i]) continue;
    ++changed;
    const auto m = static_cast<std::size_t>(markers[i]);
    state.world_from_marker[m] = replacement[i];
    for (const std::size_t index : table_.observations_of_marker[m]) {
      dirty_sets.insert(table_.observations[index].frame_set);
    }
  }
  if (!dirty_sets.empty()) localize({dirty_sets.begin(), dirty_sets.end()}, state);
  return changed;
}

}  // namespace waymark
