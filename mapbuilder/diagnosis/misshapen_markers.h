#pragma once

#include <vector>

#include "mapbuilder/diagnosis/print_fit.h"

namespace waymark {

/// A marker whose print is not square where others are: bent round a column, or stretched.
struct MisshapenMarker {
  MarkerIndex marker;
  double stretch = 0;       ///< logarithm of width over height, less what all markers show
  double sigma = 0;         ///< of it, with the other markers' spread
  std::size_t views = 0;    ///< that tell it
  std::size_t markers = 0;  ///< others that tell what is usual
};

/// Markers that fit their views only when wider or narrower than high, by rising index. Each
/// one's pose, size and stretch are fitted with the cameras where the map has them; one that stands
/// out is fitted again with cameras that other markers place alone. Views that the map rejects
/// count as well: a shape may be so wrong that nothing was accepted.
[[nodiscard]] std::vector<MisshapenMarker> find_misshapen_markers(const MapEvidence& evidence,
                                                                  const OddPrintOptions& options);

}  // namespace waymark
