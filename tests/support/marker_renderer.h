#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/camera/camera_model.h"
#include "core/capture/gray_image.h"
#include "core/geometry/rigid3.h"
#include "core/marker/marker_id.h"
#include "core/marker/marker_outline.h"

namespace waymark::testing {

/// A flat marker in front of a camera, with its paper.
struct RenderedMarker {
  MarkerId id;
  Rigid3 cam_from_marker;
  double size_m = 1.0;            ///< outer edge of the black border
  double quiet_zone_cells = 1.0;  ///< white paper around it, in the marker's cells
  double black = 40;              ///< grey levels, before the response curve
  double white = 210;
};

/// How the image is taken.
struct RenderOptions {
  double background = 120;    ///< grey level around the paper
  double psf_sigma_px = 0.8;  ///< Gaussian point spread, on top of the pixel's own square
  double noise_grey = 2.0;    ///< white Gaussian noise (grey levels)
  double gradient_grey =
      0.0;  ///< light grows by this over the image's width (grey levels, at white)
  double shadow_share = 0.0;  ///< of the light, that a shadow takes of the image's right half…
  double penumbra_px = 60.0;  ///< …over this width about the middle
  bool srgb = false;          ///< the sRGB response instead of a linear one
  std::uint64_t seed = 1;
};

/// Image of markers that do not overlap. Every cell's projected area is integrated exactly over
/// sixths of a pixel (curved by the lens where it is), then over the point spread and the pixel:
/// a noise-free edge lies within 0.002 px of its projection. The markers must lie within the
/// camera's domain (checked).
[[nodiscard]] GrayImage render_markers(const CameraModel& camera,
                                       std::span<const RenderedMarker> markers,
                                       const RenderOptions& options);

/// Where the camera sees the marker's corners.
[[nodiscard]] ImageCorners true_corners(const CameraModel& camera, const RenderedMarker& marker);

/// How a marker stands towards the camera.
struct MarkerView {
  Eigen::Vector2d center_px;
  double mean_side_px = 50;
  double tilt_rad = 0;     ///< between the marker's normal and the line of sight
  double azimuth_rad = 0;  ///< direction of the tilt
  double roll_rad = 0;     ///< about the marker's normal
};

/// Pose cam_from_marker of a marker of `size_m` seen like that (checked to lie in the camera's
/// domain).
[[nodiscard]] Rigid3 pose_seen_as(const CameraModel& camera, const MarkerView& view, double size_m);

}  // namespace waymark::testing
