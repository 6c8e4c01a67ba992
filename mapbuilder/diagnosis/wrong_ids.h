#pragma once

#include <span>
#include <vector>

#include "mapbuilder/diagnosis/map_evidence.h"

namespace waymark {

/// A detection whose id does not belong where it was seen.
struct WrongId {
  MarkerView view;
  int truly = -1;  ///< table index of the marker that stands there; −1: no mapped one
};

/// When a detection counts as a wrong id. Distances are RMS over the four corners.
struct WrongIdOptions {
  /// (0.05–0.4, of the side in the image) It shows the marker whose predicted corners lie this
  /// near: neighbours on a board are a side and more away.
  double most_to_other = 0.2;
  /// (0.3–2, of the side) and its own place lies farther off than this: blur and half-covered
  /// corners stay below.
  double least_to_own = 0.5;
  /// (0.5–5, of the side) Where no other marker is mapped, this far from its own place,
  double least_to_own_alone = 1.0;
  /// (2–10) and only by a rig that so many other markers place.
  int least_others_alone = 3;
};

/// Distance (px) of a view from the nearest of a marker's places; infinite when there are none.
[[nodiscard]] double nearest_px(const MarkerView& view, std::span<const SizedPlace> places);

/// The mapped marker other than the view's own that stands where it was seen; −1 when none does.
/// `places` per marker of the table.
[[nodiscard]] int marker_shown(const MarkerView& view,
                               std::span<const std::vector<SizedPlace>> places,
                               const WrongIdOptions& options);

/// Whether the id stands in the map only because it was read, a few times, off another marker: both
/// have one place, and the other one is seen there at least three times as often, before and after.
[[nodiscard]] bool stands_on_another(const MapEvidence& evidence, int marker);

}  // namespace waymark
