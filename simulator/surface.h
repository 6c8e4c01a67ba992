#pragma once

#include <Eigen/Core>
#include <string>

namespace waymark::simulator {

/// A flat rectangle that is seen from its front only: a wall's face, a floor, a shelf's side.
/// World frame, z up, m.
struct Surface {
  std::string name;        ///< "room.south", "shelf3.top", "divider.left"
  Eigen::Vector3d origin;  ///< lower-left corner as seen from the front
  Eigen::Vector3d right;   ///< unit
  Eigen::Vector3d up;      ///< unit, orthogonal to right; up in the world on upright faces
  double width_m = 0;      ///< along right
  double height_m = 0;     ///< along up

  /// Unit normal, out of the face towards the viewer.
  [[nodiscard]] Eigen::Vector3d normal() const { return right.cross(up); }

  /// Point `across_m` to the right and `above_m` up from the origin.
  [[nodiscard]] Eigen::Vector3d point(double across_m, double above_m) const {
    return origin + across_m * right + above_m * up;
  }
};

}  // namespace waymark::simulator
