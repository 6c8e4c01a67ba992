#include "mapbuilder/diagnosis/table_corrections.h"

#include <algorithm>
#include <numeric>
#include <utility>

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

/// Indices (as in MarkerView) of what is seen of a marker and belongs to no place that the map
/// keeps.
void leave_out(const ObservationTable& table, const DisplacedMarker& displaced,
               std::vector<std::size_t>& left_out) {
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
    if (goes(table.observations[index])) left_out.push_back(index);
  }
  for (std::size_t i = 0; i < table.repeated.size(); ++i) {
    if (goes(table.repeated[i])) left_out.push_back(table.observations.size() + i);
  }
}

void give_size(const ObservationTable& table, double size_m, TableObservation& o) {
  if (size_m == o.size_m) return;
  o.size_m = size_m;
  o.ippe = solve_ippe(camera_of(table, o).model, o.corners_px, size_m);
}

}  // namespace

TableCorrections corrections_for(const CorrectedTable& corrected,
                                 std::span<const MarkerDiagnosis> diagnoses) {
  TableCorrections corrections;
  std::vector<std::size_t> left_out;
  for (const MarkerDiagnosis& diagnosis : diagnoses) {
    for (const WrongSize& wrong : diagnosis.sizes) {
      corrections.sizes_m[wrong.marker] = wrong.fitted_m;
    }
    for (const WrongId& wrong : diagnosis.wrong_ids) left_out.push_back(wrong.view.index);
    for (const DisplacedMarker& displaced : diagnosis.displaced) {
      leave_out(corrected.table, displaced, left_out);
    }
  }
  for (const std::size_t index : left_out) {
    corrections.left_out.insert(corrected.given_index[index]);
  }
  return corrections;
}

CorrectedTable uncorrected(ObservationTable given) {
  std::vector<std::size_t> index(given.observations.size() + given.repeated.size());
  std::iota(index.begin(), index.end(), std::size_t{0});
  return {std::move(given), std::move(index)};
}

CorrectedTable correct(const ObservationTable& given, const TableCorrections& corrections) {
  CorrectedTable corrected{given, {}};
  ObservationTable& table = corrected.table;
  for (const auto& [marker, size_m] : corrections.sizes_m) {
    // Stated alike: it belongs to no other marker's size class any more.
    table.sizes_m[static_cast<std::size_t>(marker)] = size_m;
    table.stated_sizes_m[static_cast<std::size_t>(marker)] = size_m;
  }
  table.observations.clear();
  std::vector<std::size_t> repeated_index;
  for (std::size_t i = 0; i < given.repeated.size(); ++i) {
    repeated_index.push_back(given.observations.size() + i);
  }
  for (std::size_t f = 0; f < given.frame_sets.size(); ++f) {
    const TableFrameSet& set = given.frame_sets[f];
    const std::size_t first = table.observations.size();
    for (std::size_t i = 0; i < set.observation_count; ++i) {
      const std::size_t index = set.first_observation + i;
      if (corrections.left_out.contains(index)) {
        table.repeated.push_back(given.observations[index]);
        repeated_index.push_back(index);
      } else {
        table.observations.push_back(given.observations[index]);
        corrected.given_index.push_back(index);
      }
    }
    table.frame_sets[f].first_observation = first;
    table.frame_sets[f].observation_count = table.observations.size() - first;
  }
  corrected.given_index.insert(corrected.given_index.end(), repeated_index.begin(),
                               repeated_index.end());
  for (auto& indices : table.observations_of_marker) indices.clear();
  for (std::size_t i = 0; i < table.observations.size(); ++i) {
    TableObservation& o = table.observations[i];
    give_size(table, table.sizes_m[static_cast<std::size_t>(o.marker)], o);
    table.observations_of_marker[static_cast<std::size_t>(o.marker)].push_back(i);
  }
  return corrected;
}

}  // namespace waymark
