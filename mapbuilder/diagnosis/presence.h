#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/diagnosis/map_evidence.h"

namespace waymark {

/// A marker that hung on the wall during some captures and was not there during others.
struct PartTimeMarker {
  MarkerIndex marker;
  std::vector<CaptureIndex> seen_in;   ///< captures, rising
  std::vector<CaptureIndex> empty_in;  ///< captures that looked at its place and did not find it
  int empty_looks = 0;                 ///< frame sets that did
  /// Whether it came (true) or went; nullopt: the captures' clocks don't tell.
  std::optional<bool> appeared;
};

/// When a marker counts as absent.
struct PresenceOptions {
  /// (1e-9–0.01) A marker that hung there would have been missed by all who looked with less than
  /// this probability, by how seldom it is missed where it is seen: one false name in many maps.
  double most_by_chance = 1e-4;

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Mapped markers of the component that one capture sees and another one, which looks at their
/// place with clear sight, does not. Empty for a single capture.
[[nodiscard]] std::vector<PartTimeMarker> find_part_time_markers(const MapEvidence& evidence,
                                                                 const PresenceOptions& options);

}  // namespace waymark
