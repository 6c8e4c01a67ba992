#pragma once

#include <optional>

#include "mapbuilder/diagnosis/marker_places.h"

namespace waymark {

/// How a marker's second place came about.
enum class PlaceStory {
  none,                    ///< what is seen there now and then is no marker
  twin,                    ///< seen at both places in turn, or nobody looked at the empty place
  moved_during_capture,    ///< first here, then there, and one of both was seen empty
  moved_between_captures,  ///< here in some captures, there in others
};

struct PlaceHistory {
  PlaceStory story = PlaceStory::none;
  /// Which of two places is the later one; nullopt: clocks don't tell.
  std::optional<bool> second_is_later;
  bool at_once = false;      ///< one frame set saw it at both
  bool interleaved = false;  ///< seen at both places in turn
  int empty_looks = 0;  ///< frame sets that would have shown it where it no longer, or not yet, was
};

/// What tells a marker from stray readings, and a move from a twin.
struct HistoryOptions {
  /// (0.7–1) Two prints can't overlap: centres of prints whose normals enclose an angle θ are
  /// a side · cos(θ/2) apart at least. This share of it allows for the places' own errors.
  double least_print_distance = 0.9;
  /// (0.02–0.5) A marker is found in most of the frame sets that would show it; what is found in
  /// fewer than this share of them is none.
  double least_found = 0.2;
  /// (1e-6–0.05) A place counts as empty when a marker there would have been missed by all who
  /// looked with less than this probability, by how seldom it is missed where it is.
  double most_by_chance = 1e-2;

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Tells from stamps, and from looks at the empty place, how an id comes to two places.
[[nodiscard]] PlaceHistory history_of(const MapEvidence& evidence, const PlaceCluster& first,
                                      const PlaceCluster& second, const HistoryOptions& options);

}  // namespace waymark
