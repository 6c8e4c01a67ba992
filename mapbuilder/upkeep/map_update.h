#pragma once

#include <set>
#include <string>
#include <vector>

#include "mapbuilder/build/frame_comparison.h"
#include "mapbuilder/upkeep/marker_system.h"
#include "mapbuilder/upkeep/misfit.h"
#include "mapbuilder/upkeep/missing_markers.h"
#include "mapbuilder/upkeep/round_parts.h"

namespace waymark {

/// How an update takes what it finds.
struct UpdateOptions {
  std::set<MarkerId> suspects;  ///< a vehicle found them moved: they carry nothing
  bool drop_unseen = false;     ///< markers that are not where they should be leave the map
  /// What is known of the old sub-maps' markers together, one each (MAP.info); of one without
  /// markers, or where none are given, its markers count as independent.
  std::vector<MarkerSystem> systems{};
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
  std::vector<MarkerSystem> systems;  ///< of its sub-maps; without markers where nothing is known
  std::vector<UpdatedPart> parts;
  std::vector<MarkerId> improved;       ///< stand where they stood, and more surely known
  std::vector<ComparedMarker> shifted;  ///< no farther than MovedLimits, but beyond all sigmas
  std::vector<ComparedMarker> moved;    ///< placed anew
  /// Elsewhere by one view alone, or tilted in place, which may be a flip, by a round that knows
  /// their turn less than the map: left as they were.
  std::vector<ComparedMarker> doubted;
  std::vector<MarkerId> other_part;       ///< placed anew in another sub-map than before
  std::vector<MarkerId> appeared;         ///< new in the map
  std::vector<MissingMarker> missing;     ///< not where they should be; left, or dropped
  std::vector<MarkerId> unseen;           ///< as they were: nobody looked, or nothing tells
  std::vector<MarkerId> not_taken;        ///< in the old map, seen, but tied to it by nothing
  std::vector<std::size_t> joined_parts;  ///< parts of the round that see several old sub-maps
};

/// Brings `old_map` up to date by a round that was built alone. Each of the round's sub-maps is
/// laid into the old sub-map with which most of its markers agree (compare_frames), markers that
/// its views can't tell from themselves flipped as they were (unflipped), and joined with what is
/// known of those that stayed (join): these improve, and keep the world. Who lies off by more than
/// MovedLimits, but by less than five sigmas at the misfit that all show, has stayed. Markers that
/// stayed but lie off by more than that follow the round. Moved ones are placed anew where two
/// views agree on it (verified); new ones come in. Those that nobody saw stay: to the bit where
/// markers are independent, else by what the others' places tell of theirs. What is missing
/// (find_missing) stays too, as not verified, unless `drop_unseen`. A sub-map of the round without
/// any marker of the old map becomes one of the map. Where the misfit is beyond kPoorSigmas,
/// covariances of what was seen are scaled by its square, and nothing is known of the sub-map's
/// markers together any more. Old sub-maps are not joined. bad_data (`name`: the old map's path)
/// where no part of the round can be laid into the old map, and where a capture of the round went
/// into the old map: it would count twice.
[[nodiscard]] Expected<MapUpdate> update_map(const MarkerMap& old_map, const std::string& name,
                                             RoundParts& round, const UpdateOptions& options);

}  // namespace waymark
