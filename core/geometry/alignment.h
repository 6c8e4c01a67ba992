#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "core/geometry/rigid3.h"

namespace waymark {

/// target ≈ scale · rotation · source + translation.
struct Similarity3 {
  double scale = 1.0;
  Rigid3 motion;  ///< target_from_source after scaling

  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& x_in_source) const {
    return motion.rotation * (scale * x_in_source) + motion.translation;
  }
};

/// Least-squares motion between paired points (Umeyama 1991), with the scale fixed to 1 or free.
/// nullopt with fewer than 3 pairs or when the source or target points lie on a line, for then the
/// rotation is undetermined (second singular value below 1e-6 of the first).
[[nodiscard]] std::optional<Similarity3> align_points(std::span<const Eigen::Vector3d> source,
                                                      std::span<const Eigen::Vector3d> target,
                                                      bool with_scale);

/// Least-squares motion between paired poses: rotation by the chordal mean of target·source⁻¹,
/// then translation (and scale, where asked and where positions differ) by least squares.
/// Determined from one pair on; used where positions alone lie on a line. nullopt when there are no
/// pairs.
[[nodiscard]] std::optional<Similarity3> align_poses(std::span<const Rigid3> source,
                                                     std::span<const Rigid3> target,
                                                     bool with_scale);

/// Whether the points have no extent beyond a line (second singular value ≤ 1e-6 of the first).
[[nodiscard]] bool lie_on_a_line(std::span<const Eigen::Vector3d> points);

}  // namespace waymark
