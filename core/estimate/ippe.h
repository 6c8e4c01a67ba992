#pragma once

#include <array>
#include <optional>

#include "core/camera/camera_model.h"
#include "core/geometry/rigid3.h"
#include "core/marker/marker_geometry.h"

namespace waymark {

/// Both solutions of Infinitesimal Plane-based Pose Estimation (Collins and Bartoli, IJCV 2014) for
/// a square marker, better reprojection first.
struct IppeSolutions {
  std::array<Rigid3, 2> cam_from_marker;
  std::array<double, 2>
      rms_px;  ///< RMS of the corners' 2-vector norms; infinite when not projectable
};

/// Works for every camera model and direction, beyond 90° too: the corners' directions are turned
/// into a virtual pinhole camera that faces the marker, and the solutions turned back. nullopt when
/// a corner can't be undistorted, or the four are degenerate (no convex quadrangle seen from the
/// front).
[[nodiscard]] std::optional<IppeSolutions> solve_ippe(const CameraModel& camera,
                                                      const ImageCorners& corners_px,
                                                      double size_m);

}  // namespace waymark
