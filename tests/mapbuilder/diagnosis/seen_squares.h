#pragma once

#include <random>
#include <vector>

#include "core/camera/camera_model.h"
#include "core/geometry/rigid3.h"
#include "core/geometry/so3.h"
#include "core/marker/marker_geometry.h"

namespace waymark::tests {

/// Squares of 0.3 m before a camera, 1 to 5 m away all over its image, tilted by up to 60° about
/// any axis, whole in the image; corners with Gaussian noise.
inline std::vector<ImageCorners> seen_squares(const CameraModel& camera, std::size_t count,
                                              double noise_px, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const CameraParameters& p = camera.parameters();
  std::vector<ImageCorners> squares;
  while (squares.size() < count) {
    const auto bearing =
        camera.bearing({uniform(random) * p.width_px, uniform(random) * p.height_px});
    if (!bearing) continue;
    const Eigen::Vector3d at = (1.0 + 4.0 * uniform(random)) * *bearing;
    // Marker axes: z towards the camera.
    const Eigen::Quaterniond facing =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), -*bearing);
    const Eigen::Vector3d axis(normal(random), normal(random), normal(random));
    const Rigid3 pose{facing * so3_exp(axis.normalized() * 1.05 * uniform(random)), at};
    ImageCorners corners;
    bool whole = true;
    const auto in_marker = marker_corners(0.3);
    for (std::size_t i = 0; i < 4 && whole; ++i) {
      const auto pixel = camera.project(pose * in_marker[i]);
      whole = pixel && camera.in_image(*pixel);
      if (whole) {
        corners[i] = *pixel + noise_px * Eigen::Vector2d(normal(random), normal(random));
      }
    }
    if (whole && area_px2(corners) > 300) squares.push_back(corners);
  }
  return squares;
}

}  // namespace waymark::tests
