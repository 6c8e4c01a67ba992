#pragma once

#include <vector>

#include "mapbuilder/diagnosis/map_evidence.h"

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

/// When a size counts as wrong.
struct SizeOptions {
  /// (3–20) Deviation from what all other markers show, in sigmas of the fit and of their spread
  /// together: with hundreds of markers and tails that are wider than Gaussian, 6 names no sound
  /// one.
  double least_sigmas = 6.0;
  /// (0.005–0.2, relative) Below, print and calibration are to blame as well: refinement's job.
  double least_deviation = 0.03;
  /// (3–50) Views that tell a size; fewer can't contradict each other.
  int least_views = 3;
  /// (3–50) Other markers that tell the spread; among fewer nobody knows who is wrong.
  int least_markers = 5;

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Markers of wrong size, by falling certainty. Each marker's size is fitted with the cameras
/// where the map has them; one that stands out is fitted again with cameras that other markers
/// place alone. `unmapped` views count as well: a size may be so wrong that nothing was accepted.
[[nodiscard]] std::vector<WrongSize> find_wrong_sizes(const MapEvidence& evidence,
                                                      const SizeOptions& options);

}  // namespace waymark
