#include "mapbuilder/diagnosis/table_corrections.h"

#include <algorithm>

namespace waymark {
namespace {

/// First stamp of a place in each capture that saw it.
std::map<int, Stamp> first_seen(const ObservationTable& table, const PlaceCluster& cluster) {
  std::map<int, Stamp> first;
  for (const MarkerView& view : cluster.views) {
    const TableFrameSet& set =
        table.frame_sets[static_cast<std::size_t>(view.observation->frame_set)];
    const auto [known, is_new] = first.emplace(set.capture, set.stamp);
    if (!is_new) known->second = std::min(known->second, set.stamp);
  }
  return first;
}

/// Whether an observation of the marker belongs to the time before it came to the place it keeps.
bool before_the_move(const ObservationTable& table, const TableObservation& o,
                     const std::map<int, Stamp>& kept, const std::map<int, Stamp>& given_up) {
  const TableFrameSet& set = table.frame_sets[static_cast<std::size_t>(o.frame_set)];
  if (!given_up.contains(set.capture)) return false;
  const auto since = kept.find(set.capture);
  return since == kept.end() || set.stamp < since->second;
}

}  // namespace

void add_corrections(const ObservationTable& table, const MarkerDiagnosis& diagnosis,
                     TableCorrections& corrections) {
  for (const WrongSize& wrong : diagnosis.sizes) {
    corrections.sizes_m[wrong.marker] = wrong.fitted_m;
  }
  for (const WrongId& wrong : diagnosis.wrong_ids) {
    corrections.left_out.insert(wrong.view.index);
  }
  for (const DisplacedMarker& displaced : diagnosis.displaced) {
    std::map<int, Stamp> kept;
    std::map<int, Stamp> given_up;
    if (displaced.kept) {
      kept = first_seen(table, displaced.places[*displaced.kept]);
      given_up = first_seen(table, displaced.places[1 - *displaced.kept]);
    }
    const auto goes = [&](const TableObservation& o) {
      return o.marker == displaced.marker &&
             (!displaced.kept || before_the_move(table, o, kept, given_up));
    };
    for (const std::size_t index :
         table.observations_of_marker[static_cast<std::size_t>(displaced.marker)]) {
      if (goes(table.observations[index])) corrections.left_out.insert(index);
    }
  }
}

ObservationTable corrected(const ObservationTable& table, const TableCorrections& corrections) {
  ObservationTable result = table;
  for (const auto& [marker, size_m] : corrections.sizes_m) {
    // Stated alike: it belongs to no other marker's size class any more.
    result.sizes_m[static_cast<std::size_t>(marker)] = size_m;
    result.stated_sizes_m[static_cast<std::size_t>(marker)] = size_m;
  }
  result.observations.clear();
  for (std::size_t f = 0; f < table.frame_sets.size(); ++f) {
    const TableFrameSet& set = table.frame_sets[f];
    const std::size_t first = result.observations.size();
    for (std::size_t i = 0; i < set.observation_count; ++i) {
      const std::size_t index = set.first_observation + i;
      if (corrections.left_out.contains(index)) continue;
      result.observations.push_back(table.observations[index]);
    }
    result.frame_sets[f].first_observation = first;
    result.frame_sets[f].observation_count = result.observations.size() - first;
  }
  const auto give_size = [&](TableObservation& o) {
    const auto size = corrections.sizes_m.find(o.marker);
    if (size == corrections.sizes_m.end()) return;
    o.size_m = size->second;
    o.ippe = solve_ippe(camera_of(result, o).model, o.corners_px, o.size_m);
  };
  for (auto& indices : result.observations_of_marker) indices.clear();
  for (std::size_t i = 0; i < result.observations.size(); ++i) {
    TableObservation& o = result.observations[i];
    give_size(o);
    result.observations_of_marker[static_cast<std::size_t>(o.marker)].push_back(i);
  }
  return result;
}

}  // namespace waymark
