#include "mapbuilder/build/map_builder.h"

#include <algorithm>
#include <deque>
#include <set>

#include "mapbuilder/growth/loose_parts.h"

namespace waymark {
namespace {

/// Marks each observation that the finished map rests on.
std::vector<char> accepted_and_posed(const ObservationTable& table, const MapState& state) {
  std::vector<char> used(table.observations.size(), 0);
  for (std::size_t i = 0; i < used.size(); ++i) {
    used[i] = state.accepted[i] != 0 && state.posed(table.observations[i]) ? 1 : 0;
  }
  return used;
}

/// The rigid parts of a finished build, those that survey points fix in the facility's world as
/// one: what the gate rejected may have held a component together.
std::vector<Component> parts_of(const JointBuild& build) {
  std::vector<Component> parts;
  std::optional<Component> in_facility;
  for (Component& part :
       connected_components(build.table(), accepted_and_posed(build.table(), build.state()))) {
    if (!stands_in_facility(build, part)) {
      parts.push_back(std::move(part));
    } else if (!in_facility) {
      in_facility = std::move(part);
    } else {
      const auto join = [](std::vector<int>& all, const std::vector<int>& more) {
        all.insert(all.end(), more.begin(), more.end());
        std::sort(all.begin(), all.end());
      };
      join(in_facility->markers, part.markers);
      join(in_facility->frame_sets, part.frame_sets);
    }
  }
  if (in_facility) parts.push_back(*std::move(in_facility));
  return parts;
}

}  // namespace

BuildResult build_map(ObservationTable& table, const BuildOptions& options, Progress& progress) {
  BuildResult result;
  result.map.builder_version = WAYMARK_VERSION;
  result.map.capture_fingerprints = table.capture_fingerprints;
  std::sort(result.map.capture_fingerprints.begin(), result.map.capture_fingerprints.end());
  result.map.rig_fingerprint = table.rig_fingerprint;

  MapState state(table);
  const std::vector<Component> components =
      connected_components(table, std::vector<char>(table.observations.size(), 1));
  std::deque<ComponentGrowth> growths;
  std::vector<ComponentGrowth*> all;
  for (const Component& component : components) {
    all.push_back(&growths.emplace_back(table, component, options));
    all.back()->grow(state, progress);
    JointBuild alone(table, {all.back()}, options, progress, state);
    alone.settle();
    rehang_loose_parts(alone);
  }
  std::set<int> mapped;
  std::set<int> localized;
  if (!all.empty()) {
    JointBuild build(table, all, options, progress, state);
    result.calibration = calibrate(build);
    for (const Component& part : parts_of(build)) {
      result.submaps.push_back(describe(build, part));
      mapped.insert(part.markers.begin(), part.markers.end());
      localized.insert(part.frame_sets.begin(), part.frame_sets.end());
    }
  }
  std::stable_sort(result.submaps.begin(), result.submaps.end(),
                   [](const BuiltSubMap& a, const BuiltSubMap& b) {
                     if (a.map.markers.size() != b.map.markers.size()) {
                       return a.map.markers.size() > b.map.markers.size();
                     }
                     return a.map.markers.front().id < b.map.markers.front().id;
                   });
  for (const BuiltSubMap& submap : result.submaps) result.map.submaps.push_back(submap.map);

  for (std::size_t m = 0; m < table.markers.size(); ++m) {
    if (!mapped.contains(static_cast<int>(m))) result.unmapped.push_back(table.markers[m]);
  }
  for (std::size_t f = 0; f < table.frame_sets.size(); ++f) {
    if (table.frame_sets[f].observation_count == 0) {
      result.without_markers.push_back(static_cast<int>(f));
    } else if (!localized.contains(static_cast<int>(f))) {
      result.unlocalized.push_back(static_cast<int>(f));
    }
  }
  return result;
}

}  // namespace waymark
