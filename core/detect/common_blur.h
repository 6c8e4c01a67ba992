#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/detect/corner_refiner.h"

namespace waymark {

/// How blurred an image is, by the markers whose paper is not saturated. Where paper is saturated
/// only the foot of an edge's step is seen, from which blur, white level and place of the edge
/// can't be told apart.
class CommonBlur {
 public:
  void clear() { sides_.clear(); }

  /// A marker's sides; a saturated one's are left out.
  void add(const RefinedCorners& marker);

  /// Their median and how far they truly differ (defocus, motion, what the fits can't tell taken
  /// off); nullopt with fewer than three markers.
  [[nodiscard]] std::optional<BlurPrior> prior();

 private:
  std::vector<SideBlur> sides_;
  std::vector<double> scratch_;  ///< kept for its memory
};

/// From this share of saturated paper on (0–1), a marker does not tell its blur and is refined with
/// the others'. One pixel in fifty is noise; at a fifth the white plateau is gone on some side.
inline constexpr double kSaturatedPaper = 0.05;

}  // namespace waymark
