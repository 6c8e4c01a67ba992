#pragma once

#include <string>
#include <vector>

#include "core/base/range.h"
#include "core/camera/rig.h"

namespace waymark {

/// Distances that advice is given for.
inline constexpr Range kAdviceRange_m{0.1, 200};

/// Which size a camera needs at a distance, and how close markers must stand.
struct PrintAdvice {
  std::string camera;
  double field_rad = 0;   ///< seen from left to right
  double size_m = 0;      ///< of tag36h11: four pixels a cell at the range, turned by 45°
  double readable_m = 0;  ///< how far off the rounded size is read so, seen from the front
  double spacing_m = 0;   ///< along a wall at half the range: four markers in view
};

/// One entry per camera. `range_m` is the farthest distance at which markers are to be read, in
/// kAdviceRange_m (checked). Sizes are rounded up to the centimetre.
[[nodiscard]] std::vector<PrintAdvice> print_advice(const Rig& rig, double range_m);

/// Lines for people: per camera size and spacing, then the size for all.
[[nodiscard]] std::string advice_text(const std::vector<PrintAdvice>& advice, double range_m);

}  // namespace waymark
