#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/map/marker_map.h"
#include "mapbuilder/build/frame_comparison.h"

namespace waymark {

/// A sub-map of the new map against one of the old.
struct SubMapDifference {
  std::size_t old_submap = 0;
  std::size_t new_submap = 0;
  FrameKind old_frame = FrameKind::arbitrary;
  FrameKind new_frame = FrameKind::arbitrary;
  bool old_z_is_up = false;
  bool new_z_is_up = false;
  std::size_t common = 0;  ///< markers of both
  /// Laid on each other by those that stayed. Its moved markers are all others of both.
  FrameComparison comparison;
  /// Lengths in the old sub-map to those in the new, by the markers that stayed; nullopt where they
  /// are fewer than 3, or one spot.
  std::optional<double> old_from_new_scale;
  double scale_sigma = 0;  ///< one standard deviation of it, by how the stayed ones scatter
  /// By what the new one's lengths were multiplied before: 1 unless more markers agree otherwise.
  double compared_at_scale = 1;
  /// How far a place among the markers that stayed lies from its old place in the world, at most.
  double world_shift_m = 0;
  double world_turn_rad = 0;
  std::optional<double> old_median_sigma_m;  ///< of positions (root of the trace), where known
  std::optional<double> new_median_sigma_m;

  /// Whether more than half of the common markers carry the comparison.
  [[nodiscard]] bool by_majority() const { return 2 * comparison.stayed.size() > common; }
};

/// A marker that stands in both maps at one place, under two names.
struct RenamedMarker {
  MarkerId from;
  MarkerId to;
};

/// A marker of both maps whose size differs.
struct ResizedMarker {
  MarkerId id;
  double old_size_m = 0;  ///< the one the map was built with
  double new_size_m = 0;
};

/// What differs between two maps of one building.
struct MapDifference {
  std::string old_hash;
  std::string new_hash;
  std::size_t old_markers = 0;
  std::size_t new_markers = 0;
  std::size_t old_submaps = 0;
  std::size_t new_submaps = 0;
  bool several_families = false;  ///< in both together
  /// Every pair of sub-maps that could be laid on each other, by new, then old sub-map.
  std::vector<SubMapDifference> submaps;
  std::vector<MarkerId> appeared;      ///< in no old sub-map, not renamed
  std::vector<MarkerId> vanished;      ///< in no new sub-map, not renamed
  std::vector<RenamedMarker> renamed;  ///< by rising old id
  std::vector<ResizedMarker> resized;
  std::vector<MarkerId> verified;      ///< now, and not in the old map
  std::vector<MarkerId> unverified;    ///< in the old map, and not now
  std::vector<MarkerId> not_compared;  ///< of both maps, in sub-maps that share too few markers

  /// The maps' content is one and the same.
  [[nodiscard]] bool same() const { return old_hash == new_hash; }
};

/// Compares two maps, whatever frames they are in. Sub-maps are laid on each other by
/// compare_frames, with MovedLimits as they are; of two common markers both must agree, and a
/// single one suffices where it is the whole of a sub-map. Lengths are compared by ratios between
/// markers, which no frame changes: where a common factor makes more markers agree, the new sub-map
/// is compared at that. Renamed is who vanished where another of its family and size has appeared,
/// within MovedLimits. bad_data, naming both (`old_name`, `new_name`), where nothing can be laid on
/// anything: no common markers, or none that agree.
[[nodiscard]] Expected<MapDifference> difference_of(const MarkerMap& old_map,
                                                    const std::string& old_name,
                                                    const MarkerMap& new_map,
                                                    const std::string& new_name);

}  // namespace waymark
