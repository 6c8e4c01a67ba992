#include "mapbuilder/build/map_builder.h"

#include <algorithm>
#include <set>

#include "core/base/check.h"
#include "core/camera/kalibr.h"
#include "mapbuilder/growth/misplaced_subgraphs.h"
#include "mapbuilder/observations/covisibility.h"
#include "mapbuilder/observations/detected_capture.h"

namespace waymark {
namespace {

/// Components as far as they have grown.
struct GrownComponents {
  Estimate estimate;
  bool given_up = false;
};

/// What holds of an estimate when sizes change: markers whose size is another lose their pose, and
/// the frame sets that see them are localized by the others. Nothing holds where a seed loses its
/// pose with them, for it bears the component's world.
Estimate with_new_sizes(const IncrementalMapper& mapper, Estimate estimate) {
  const Selection& selection = mapper.selection();
  std::set<FrameSetIndex> seeing;
  for (const MarkerIndex m : selection.observations().markers.indices()) {
    if (estimate.calibration.sizes_m[m] == selection.stated_sizes_m()[m]) continue;
    estimate.world_from_marker[m].reset();
    for (const ObservationIndex index : selection.used_of(m)) {
      estimate.accepted[index] = 1;
      seeing.insert(selection[index].frame_set);
    }
  }
  estimate.calibration = Calibration(selection);
  estimate = mapper.localize(std::vector(seeing.begin(), seeing.end()), std::move(estimate));
  for (const ComponentIndex c : selection.components().indices()) {
    if (!estimate.world_from_rig[mapper.seed_of(c)]) return {selection, mapper.options().noise};
  }
  return estimate;
}

/// Every component grown and at rest, each in a world of its own; none after one that is given up.
GrownComponents grown_components(const IncrementalMapper& mapper, std::optional<Estimate> start,
                                 Progress& progress) {
  Estimate estimate = start ? with_new_sizes(mapper, *std::move(start))
                            : Estimate(mapper.selection(), mapper.options().noise);
  for (const ComponentIndex c : mapper.selection().components().indices()) {
    estimate = mapper.grow(c, std::move(estimate), progress);
    if (mapper.gives_up(c, estimate)) return {std::move(estimate), true};
    estimate = mapper.converge({{c}, {}}, std::move(estimate), progress).estimate;
    estimate = move_misplaced_subgraphs(mapper, c, std::move(estimate), progress);
  }
  return {std::move(estimate), false};
}

/// The observations that the finished map rests on.
std::vector<ObservationIndex> mapping_observations(const Selection& selection,
                                                   const Estimate& estimate) {
  std::vector<ObservationIndex> mapping;
  for (const ObservationIndex index : selection.used()) {
    if (estimate.accepts(index) && estimate.posed(selection[index])) mapping.push_back(index);
  }
  return mapping;
}

template <typename Key>
void join(std::vector<Key>& all, const std::vector<Key>& more) {
  all.insert(all.end(), more.begin(), more.end());
  std::sort(all.begin(), all.end());
}

/// The connected components of a finished estimate, those that survey points fix in the facility's
/// world as one: what the gate rejected may have held a component together.
std::vector<Component> finished_components(const Selection& selection,
                                           const CalibratedEstimate& calibrated) {
  const Observations& observations = selection.observations();
  std::vector<Component> components;
  std::optional<Component> in_facility;
  for (Component& one :
       connected_components(observations, mapping_observations(selection, calibrated.estimate))) {
    if (!stands_in_facility(observations, calibrated, one)) {
      components.push_back(std::move(one));
    } else if (!in_facility) {
      in_facility = std::move(one);
    } else {
      join(in_facility->markers, one.markers);
      join(in_facility->frame_sets, one.frame_sets);
    }
  }
  if (in_facility) components.push_back(*std::move(in_facility));
  return components;
}

/// Whether a component is one marker of one frame set: a misreading as likely as a marker, and no
/// map of anything.
bool is_lone_sight(const Component& component) {
  return component.markers.size() == 1 && component.frame_sets.size() == 1;
}

/// By falling marker count, then first marker.
void sort_submaps(std::vector<BuiltSubMap>& submaps) {
  std::stable_sort(submaps.begin(), submaps.end(), [](const BuiltSubMap& a, const BuiltSubMap& b) {
    if (a.map.markers.size() != b.map.markers.size()) {
      return a.map.markers.size() > b.map.markers.size();
    }
    return a.map.markers.front().id < b.map.markers.front().id;
  });
}

/// What no sub-map holds.
void take_what_is_left(const Selection& selection, std::span<const Component> mapped,
                       BuildResult& result) {
  const Observations& observations = selection.observations();
  std::set<MarkerIndex> markers;
  std::set<FrameSetIndex> frame_sets;
  for (const Component& component : mapped) {
    markers.insert(component.markers.begin(), component.markers.end());
    frame_sets.insert(component.frame_sets.begin(), component.frame_sets.end());
  }
  for (const MarkerIndex m : observations.markers.indices()) {
    if (!markers.contains(m)) result.unmapped.push_back(observations.markers[m]);
  }
  for (const FrameSetIndex f : observations.frame_sets.indices()) {
    const auto used = selection.used_in(f);
    const bool lone_sight =
        used.size() == 1 && selection.used_of(selection[used.front()].marker).size() == 1;
    if (used.empty() || (lone_sight && !frame_sets.contains(f))) {
      result.without_markers.push_back(f);
    } else if (!frame_sets.contains(f)) {
      result.unlocalized.push_back(f);
    }
  }
}

/// That of refined rigs, as their files will be read.
std::string fingerprint_of_refined(const Calibration& calibration) {
  std::vector<Rig> read;
  for (const Rig& rig : calibration.rigs) {
    auto again = parse_camchain(format_camchain(rig), "refined rig");
    read.push_back(again ? std::move(again->rig) : rig);
  }
  return fingerprint(read);
}

/// The map file's content.
MarkerMap map_of(const Observations& observations, const CalibratedEstimate& calibrated,
                 const std::vector<BuiltSubMap>& submaps) {
  MarkerMap map;
  map.builder_version = WAYMARK_VERSION;
  for (const ObservedCapture& capture : observations.captures) {
    map.capture_fingerprints.push_back(capture.fingerprint);
  }
  std::sort(map.capture_fingerprints.begin(), map.capture_fingerprints.end());
  map.rig_fingerprint = calibrated.calibration.refined
                            ? fingerprint_of_refined(calibrated.estimate.calibration)
                            : observations.rig_fingerprint;
  for (const BuiltSubMap& submap : submaps) map.submaps.push_back(submap.map);
  return map;
}

}  // namespace

BuildResult build_map(const Selection& selection, const BuildOptions& options, Progress& progress,
                      std::optional<Estimate> start) {
  WAYMARK_CHECK(!start || (!options.refine.any() && options.survey.empty()));
  const IncrementalMapper mapper(selection, options);
  BuildResult result;
  GrownComponents grown = grown_components(mapper, std::move(start), progress);
  if (grown.given_up) {
    result.given_up = true;
    return result;
  }
  CalibratedEstimate calibrated = calibrate(mapper, options, std::move(grown.estimate), progress);
  std::vector<Component> components = finished_components(selection, calibrated);
  if (!std::all_of(components.begin(), components.end(), is_lone_sight)) {
    std::erase_if(components, is_lone_sight);
  }
  for (const Component& component : components) {
    result.submaps.push_back(built_submap_of(mapper, calibrated, options, component));
  }
  sort_submaps(result.submaps);
  result.map = map_of(selection.observations(), calibrated, result.submaps);
  take_what_is_left(selection, components, result);
  result.calibration = std::move(calibrated.calibration);
  result.estimate = std::move(calibrated.estimate);
  return result;
}

}  // namespace waymark
