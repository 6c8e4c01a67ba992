#pragma once

#include <vector>

#include "mapbuilder/diagnosis/print_fit.h"

namespace waymark {

/// A marker whose stated size does not fit.
struct WrongSize {
  MarkerIndex marker;
  double stated_m = 0;
  double fitted_m = 0;
  double sigma_m = 0;       ///< of the fitted size
  double spread = 0;        ///< robust, relative: how far other markers' sizes are off
  std::size_t views = 0;    ///< that tell the size
  std::size_t markers = 0;  ///< that tell the spread
};

/// Markers of wrong size, by rising index. Each marker's size is fitted with the cameras where the
/// map has them; one that stands out is fitted again with cameras that other markers place alone.
/// Views that the map rejects count as well: a size may be so wrong that nothing was accepted.
[[nodiscard]] std::vector<WrongSize> find_wrong_sizes(const MapEvidence& evidence,
                                                      const OddPrintOptions& options);

}  // namespace waymark
