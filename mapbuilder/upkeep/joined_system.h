#pragma once

#include <set>
#include <vector>

#include "mapbuilder/upkeep/marker_system.h"
#include "mapbuilder/upkeep/round_parts.h"

namespace waymark {

/// What is known of named markers together; ids rising.
struct KnownMarkers {
  std::vector<MarkerId> ids;
  MarkerSystem system;

  /// Of those of its markers that `keep` names.
  [[nodiscard]] KnownMarkers marginal(const std::set<MarkerId>& keep) const;
};

/// What a part of a round tells of its markers together, by its own optimum laid into another world
/// (`world_from_round`): the normal equations of eq. 11 with the rigs eliminated. Markers that do
/// not hang together with one of `tied_by` by frame sets of two markers or more are left out; with
/// none given, nobody is.
[[nodiscard]] KnownMarkers known_by_round(const RoundParts& round, const RoundPart& part,
                                          const Rigid3& world_from_round,
                                          const std::vector<MarkerId>& tied_by);

/// What a build knows of each of its sub-maps' markers together, in its map's worlds and order; one
/// without markers where that is not said of all of them. Of a build without survey and refinement:
/// these tie all markers by what is not among them.
[[nodiscard]] std::vector<MarkerSystem> systems_of_build(const RoundParts& build);

/// Two accounts of markers together.
struct JoinedMarkers {
  KnownMarkers known;                 ///< at the joint optimum
  std::vector<Matrix6d> covariances;  ///< marginal; empty where the two don't determine them all
};

/// The optimum of both, to first order: (N₁ + N₂) δ = N₂ d, δ and d from the places that `earlier`
/// has. Where it does not fix the world, the mean motion of its markers is nought, and the
/// covariances are in the gauge of marker_covariances.
[[nodiscard]] JoinedMarkers join(const KnownMarkers& earlier, const KnownMarkers& round);

}  // namespace waymark
