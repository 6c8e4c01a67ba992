#pragma once

#include <vector>

#include "mapbuilder/diagnosis/map_evidence.h"

namespace waymark {

/// A marker whose print is not square where others are: bent round a column, or stretched.
struct MisshapenMarker {
  MarkerIndex marker;
  double stretch = 0;       ///< logarithm of width over height, less what all markers show
  double sigma = 0;         ///< of it, with the other markers' spread
  std::size_t views = 0;    ///< that tell it
  std::size_t markers = 0;  ///< others that tell what is usual
};

/// When a print counts as not square.
struct ShapeOptions {
  /// (3–20) Deviation from what all other markers show, in sigmas of the fit and of their spread
  /// together; as with sizes, 6 names no sound one.
  double least_sigmas = 6.0;
  /// (0.005–0.2, of the width) Below, paper and lens are to blame as well.
  double least_deviation = 0.02;
  /// (3–50) Views that tell a shape; fewer can't contradict each other.
  int least_views = 3;
  /// (3–50) Other markers that tell the spread; among fewer nobody knows who is wrong.
  int least_markers = 5;

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Markers that fit their views only when wider or narrower than high, by rising index. Each
/// one's pose, size and stretch are fitted with the cameras where the map has them; one that stands
/// out is fitted again with cameras that other markers place alone. Views that the map rejects
/// count as well: a shape may be so wrong that nothing was accepted.
[[nodiscard]] std::vector<MisshapenMarker> find_misshapen_markers(const MapEvidence& evidence,
                                                                  const ShapeOptions& options);

}  // namespace waymark
