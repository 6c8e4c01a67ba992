#pragma once

#include <optional>
#include <span>
#include <vector>

#include "mapbuilder/growth/incremental_mapper.h"

namespace waymark {

/// A subgraph of a component that hangs on the rest by the accepted observations of one marker, or
/// by none, with the place that the rejected ones between both agree on.
struct MisplacedSubgraph {
  Component subgraph;
  std::optional<MarkerIndex> hinge;     ///< the marker it hangs on
  Rigid3 new_from_old;                  ///< world from world, for all its poses
  std::vector<ObservationIndex> links;  ///< rejected observations that fit there, rising
  std::size_t markers = 0;              ///< different ones among them; two at least
};

/// The subgraphs that other observations would rather have elsewhere, most markers first. One
/// marker is weak evidence: an id that exists twice, or is read wrongly, hangs a part of the
/// building where it is not, and growth can't see that before it meets the rest. The rest is what
/// holds `anchor`.
[[nodiscard]] std::vector<MisplacedSubgraph> find_misplaced_subgraphs(
    const PreparedObservations& prepared, std::span<const ObservationIndex> observations,
    FrameSetIndex anchor, const Estimate& estimate);

/// Moves misplaced subgraphs of a converged component to where most markers agree and lets it
/// converge again, as long as fewer markers contradict the map afterwards and its noise has not
/// grown; else it stays as it was.
[[nodiscard]] Estimate move_misplaced_subgraphs(const IncrementalMapper& mapper,
                                                ComponentIndex component, Estimate estimate,
                                                Progress& progress);

}  // namespace waymark
