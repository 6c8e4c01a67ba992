#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/diagnosis/map_evidence.h"

namespace waymark {

/// What tells a marker that moves from one that hangs.
struct MovementOptions {
  /// (3–50) Views that tell a path.
  int least_views = 6;
  /// (0.05–0.5, of the side in the image) Views this near to where a place shows the marker agree
  /// with it.
  double agrees = 0.25;
  /// (0.5–1) Share of the views that must agree that a marker rides.
  double least_riding = 0.8;
  /// (0.1–10 m) How far the rig must have gone, or
  double least_way_m = 0.5;
  double least_turn_rad = 0.5;  ///< (0.1–3) turned, while a marker rode on it.
  /// (2–5) Markers that make a group: two may agree by chance.
  int least_group = 3;
};

/// A marker that a camera sees always at one place of the rig, while the rig moves.
struct RidingMarker {
  MarkerIndex marker;
  std::vector<MarkerView> views;
  double way_m = 0;  ///< extent of the rig's places in these views
};

/// A marker of which hardly two views agree on a place.
struct RestlessMarker {
  MarkerIndex marker;
  std::vector<MarkerView> views;
};

/// Markers that stand still against each other, seen together elsewhere than where they hang.
struct MovingGroup {
  std::vector<MarkerIndex> markers;  ///< rising
  std::vector<MarkerView> views;     ///< all of theirs in the images that show the group
  std::size_t images = 0;
};

[[nodiscard]] std::optional<RidingMarker> find_riding(const std::vector<MarkerView>& views,
                                                      const MovementOptions& options);

[[nodiscard]] std::optional<RestlessMarker> find_restless(const std::vector<MarkerView>& views,
                                                          const MovementOptions& options);

/// Groups among views that lie off their markers' places: pairs of one image whose distance in
/// sides is the same in three images or more, or of which markers.toml states that they move
/// together: then two are a group.
[[nodiscard]] std::vector<MovingGroup> find_moving_groups(const MapEvidence& evidence,
                                                          const std::vector<MarkerView>& elsewhere,
                                                          const MovementOptions& options);

}  // namespace waymark
