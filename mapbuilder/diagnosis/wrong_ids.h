#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/diagnosis/map_evidence.h"

namespace waymark {

/// A detection whose id does not belong where it was seen.
struct WrongId {
  MarkerView view;
  std::optional<MarkerIndex> truly;  ///< the marker that stands there; nullopt: no mapped one
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

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// The places of every marker: none, one, or several of one id.
using PlacesOfMarkers = IndexedVector<MarkerIndex, std::vector<SizedPlace>>;

/// Tells wrong ids by where the map's markers are.
class WrongIdJudge {
 public:
  WrongIdJudge(const MapEvidence& evidence, const PlacesOfMarkers& places,
               const WrongIdOptions& options)
      : evidence_(evidence), places_(places), options_(options) {}

  /// The mapped marker other than the view's own that stands where it was seen.
  /// The rig's pose may give way within what the other markers of the frame set accept.
  [[nodiscard]] std::optional<MarkerIndex> marker_shown(const MarkerView& view) const;

  /// The view as a wrong id, when it lies off all of its own places and on another marker's.
  [[nodiscard]] std::optional<WrongId> wrong_id(const MarkerView& view) const;

  /// The view as a wrong id that shows no mapped marker: far off all of its own places, by a rig
  /// that is beyond doubt.
  [[nodiscard]] std::optional<WrongId> stray(const MarkerView& view) const;

  /// Of two observations, all that a frame set sees, at most one has a right id when no pose of the
  /// rig shows both at their places. It is the other one if only that one can be another marker.
  [[nodiscard]] std::optional<WrongId> wrong_of_two(FrameSetIndex frame_set) const;

 private:
  [[nodiscard]] double nearest_px(const MarkerView& view) const;
  [[nodiscard]] std::optional<MarkerIndex> shown_beside(const MarkerView& view,
                                                        const MarkerView& right) const;
  [[nodiscard]] bool fit_together(const MarkerView& a, const SizedPlace& place_of_a,
                                  const MarkerView& b, const SizedPlace& place_of_b) const;

  const MapEvidence& evidence_;
  const PlacesOfMarkers& places_;
  WrongIdOptions options_;
};

/// Whether the id stands in the map only because it was read, a few times, off another marker: both
/// have one place, and the other one is seen there at least twice as often, before and after.
[[nodiscard]] bool stands_on_another(const MapEvidence& evidence, MarkerIndex marker);

}  // namespace waymark
