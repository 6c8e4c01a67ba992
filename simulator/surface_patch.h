#pragma once

#include <vector>

#include "simulator/camera_view.h"
#include "simulator/renderer.h"
#include "simulator/tile_rays.h"

namespace waymark::simulator {

/// Albedo and light of one surface over a tile, computed at nodes a few pixels apart and
/// interpolated between: walls are smooth at that scale. The surface is continued beyond its edges,
/// for the sub-pixels at them.
class SurfacePatch {
 public:
  /// `share`: see MovingPlane::at.
  void compute(const Renderer::Stage& stage, const RayTable& rays, const SubpixelGrid& grid,
               const MovingPlane& plane, float share);

  /// One row of sub-pixels, phase by phase.
  void interpolate_albedo(const SubpixelGrid& grid, std::size_t row, float* out) const;
  void interpolate_light(const SubpixelGrid& grid, std::size_t row, float* out) const;

  /// Pixels beyond a tile's apron at which nodes may lie.
  static constexpr int kReach_px = 16;

 private:
  std::vector<float> albedo_, light_;
};

}  // namespace waymark::simulator
