#pragma once

#include <set>
#include <string>
#include <vector>

#include "mapbuilder/build/frame_comparison.h"
#include "mapbuilder/upkeep/missing_markers.h"
#include "mapbuilder/upkeep/round_parts.h"

namespace waymark {

/// How an update takes what it finds.
struct UpdateOptions {
  std::set<MarkerId> suspects;  ///< a vehicle found them moved: they carry nothing
  bool drop_unseen = false;     ///< markers that are not where they should be leave the map
};

/// A part of a round laid into a sub-map of the old map.
struct UpdatedPart {
  std::size_t old_submap = 0;
  std::size_t round_submap = 0;
  FrameComparison comparison;
  /// What round and map differ by, in what their sigmas say: 1 where these hold.
  double misfit_sigmas = 1;
};

/// An old map brought up to date by a round.
struct MapUpdate {
  MarkerMap map;
  std::vector<UpdatedPart> parts;
  std::vector<MarkerId> improved;         ///< stand where they stood, and more surely known
  std::vector<ComparedMarker> shifted;    ///< no farther than MovedLimits, but beyond all sigmas
  std::vector<ComparedMarker> moved;      ///< placed anew
  std::vector<ComparedMarker> doubted;    ///< elsewhere by one view alone: left as they were
  std::vector<MarkerId> other_part;       ///< placed anew in another sub-map than before
  std::vector<MarkerId> appeared;         ///< new in the map
  std::vector<MissingMarker> missing;     ///< not where they should be; left, or dropped
  std::vector<MarkerId> unseen;           ///< as they were: nobody looked, or nothing tells
  std::vector<MarkerId> not_taken;        ///< in the old map, seen, but tied to it by nothing
  std::vector<std::size_t> joined_parts;  ///< parts of the round that see several old sub-maps
};

/// Brings `old_map` up to date by a round that was built alone. Each of the round's sub-maps is
/// laid into the old sub-map with which most of its markers agree (compare_frames), and adjusted
/// again together with what the old map knows of those that stayed (adjust_with_priors): these
/// improve, and keep the world. Who lies off by more than MovedLimits, but by less than five sigmas
/// at the misfit that all show, has stayed. Markers that stayed but lie off by more than five
/// sigmas of both (at the misfit that all show) follow the round. Moved ones are placed anew where
/// two views agree on it (verified); new ones come in; those that nobody saw stay as they were, to
/// the bit. What is missing (find_missing) stays too, as not verified, unless `drop_unseen`. A
/// sub-map of the round without any marker of the old map becomes one of the map. Covariances of
/// what was adjusted are scaled by misfit_sigmas², where that is above 1. Old sub-maps are not
/// joined. bad_data (`name`: the old map's path) where no part of the round can be laid into the
/// old map, and where a capture of the round went into the old map: it would count twice.
[[nodiscard]] Expected<MapUpdate> update_map(const MarkerMap& old_map, const std::string& name,
                                             const RoundParts& round, const UpdateOptions& options);

}  // namespace waymark
