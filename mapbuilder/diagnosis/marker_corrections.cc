#include "mapbuilder/diagnosis/marker_corrections.h"

#include <algorithm>
#include <map>

namespace waymark {
namespace {

/// First stamp of a place in each capture that saw it.
std::map<CaptureIndex, Stamp> first_seen(const Observations& observations,
                                         const PlaceCluster& cluster) {
  std::map<CaptureIndex, Stamp> first;
  for (const MarkerView& view : cluster.views) {
    const ObservedFrameSet& set = observations.frame_sets[view.frame_set];
    const auto [known, is_new] = first.emplace(set.capture, set.stamp);
    if (!is_new) known->second = std::min(known->second, set.stamp);
  }
  return first;
}

/// Leaves out all that is seen of a marker.
void leave_out(const Selection& selection, MarkerIndex marker, Corrections& corrections) {
  for (const auto indices : {selection.used(), selection.unused()}) {
    for (const ObservationIndex index : indices) {
      if (selection[index].marker == marker) corrections.left_out.insert(index);
    }
  }
}

/// Leaves out what is seen of a marker and belongs to no place that the map keeps.
void leave_out(const Selection& selection, const DisplacedMarker& displaced,
               Corrections& corrections) {
  const Observations& observations = selection.observations();
  std::map<CaptureIndex, Stamp> kept;
  std::map<CaptureIndex, Stamp> given_up;
  if (displaced.kept) {
    kept = first_seen(observations, displaced.places[*displaced.kept]);
    given_up = first_seen(observations, displaced.places[1 - *displaced.kept]);
  }
  /// Whether an observation belongs to the time before the marker came to the place it keeps.
  const auto before_the_move = [&](const Observation& o) {
    const ObservedFrameSet& set = observations.frame_sets[o.frame_set];
    if (!given_up.contains(set.capture)) return false;
    const auto since = kept.find(set.capture);
    return since == kept.end() || set.stamp < since->second;
  };
  for (const auto indices : {selection.used(), selection.unused()}) {
    for (const ObservationIndex index : indices) {
      const Observation& o = selection[index];
      if (o.marker != displaced.marker) continue;
      if (!displaced.kept || before_the_move(o)) corrections.left_out.insert(index);
    }
  }
}

}  // namespace

Corrections corrections_for(const Selection& selection,
                            std::span<const MarkerDiagnosis> diagnoses) {
  Corrections corrections;
  for (const MarkerDiagnosis& diagnosis : diagnoses) {
    for (const WrongSize& wrong : diagnosis.sizes) {
      corrections.sizes_m[wrong.marker] = wrong.fitted_m;
    }
    for (const MisshapenMarker& misshapen : diagnosis.misshapen) {
      leave_out(selection, misshapen.marker, corrections);
    }
    for (const RidingMarker& riding : diagnosis.riding) {
      leave_out(selection, riding.marker, corrections);
    }
    for (const RestlessMarker& restless : diagnosis.restless) {
      leave_out(selection, restless.marker, corrections);
    }
    for (const MovingGroup& group : diagnosis.groups) {
      for (const MarkerView& view : group.views) corrections.left_out.insert(view.index);
    }
    for (const WrongId& wrong : diagnosis.wrong_ids) corrections.left_out.insert(wrong.view.index);
    // What was left out because it had put its marker elsewhere stays out as a stray.
    for (const WrongId& stray : diagnosis.strays) {
      if (selection.corrections().left_out.contains(stray.view.index)) {
        corrections.left_out.insert(stray.view.index);
      }
    }
    for (const DisplacedMarker& displaced : diagnosis.displaced) {
      leave_out(selection, displaced, corrections);
    }
  }
  return corrections;
}

}  // namespace waymark
