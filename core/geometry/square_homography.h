#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

namespace waymark {

/// Homography that takes the unit square's corners (0,0) (1,0) (1,1) (0,1) to `quad`, its last
/// element 1 (Heckbert's closed form). nullopt when three corners lie on a line.
[[nodiscard]] std::optional<Eigen::Matrix3d> homography_from_unit_square(
    const std::array<Eigen::Vector2d, 4>& quad);

}  // namespace waymark
