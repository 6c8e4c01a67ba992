#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/geometry/rigid3.h"

namespace waymark {

/// How far one pose lies from its truth, after alignment.
struct PoseError {
  double translation_m = 0;
  double rotation_rad = 0;  ///< geodesic
};

/// Root mean squares over poses.
struct PoseRmse {
  double translation_m = 0;
  double rotation_rad = 0;
};

/// Accuracy of estimated poses against true ones.
struct PoseAccuracy {
  Rigid3 truth_from_estimate;          ///< SE(3), without scale
  bool positions_on_a_line = false;    ///< then corners or whole poses were aligned
  PoseRmse rmse;                       ///< after truth_from_estimate
  double scale = 1;                    ///< that best carries the estimate onto the truth, Sim(3)
  double sim3_translation_rmse_m = 0;  ///< after that similarity
  std::vector<PoseError> each;         ///< after truth_from_estimate, in the input's order
};

/// An estimated pose and its truth.
struct PosePair {
  Rigid3 estimate;
  Rigid3 truth;
};

/// A marker's estimated and true world_from_marker.
struct MarkerPair {
  PosePair pose;
  double size_m = 0;
};

/// Markers aligned on their centres or, where those lie on a line, on their corners. nullopt
/// without markers.
[[nodiscard]] std::optional<PoseAccuracy> accuracy_of_markers(std::span<const MarkerPair> markers);

/// Cameras (or rigs) aligned on their positions or, where those lie on a line, on whole poses.
/// nullopt without poses.
[[nodiscard]] std::optional<PoseAccuracy> accuracy_of_cameras(std::span<const PosePair> poses);

/// Errors after a given alignment, such as that of the markers: what a vehicle gets.
[[nodiscard]] std::vector<PoseError> pose_errors(std::span<const PosePair> poses,
                                                 const Rigid3& truth_from_estimate);
[[nodiscard]] PoseRmse rmse_of(std::span<const PoseError> errors);

}  // namespace waymark
