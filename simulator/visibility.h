#pragma once

#include <unordered_map>
#include <vector>

#include "core/camera/camera_model.h"
#include "core/marker/marker_geometry.h"
#include "simulator/occlusion.h"
#include "simulator/scene.h"

namespace waymark::simulator {

/// From when on a marker counts as one that a detector finds.
struct VisibilityLimits {
  double least_side_px =
      25;  ///< of the shortest of the four edges; 12…; below, cells of a 4×4 marker blur
  double most_obliquity_deg =
      75;                ///< between the marker's normal and the ray from its centre to the camera
  double border_px = 8;  ///< between each corner and the image's edge: room for the white margin
};

/// A marker as a camera sees it, without noise.
struct VisibleMarker {
  std::size_t marker = 0;  ///< index into Scene::markers
  ImageCorners corners;    ///< px, distorted
};

/// Answers which markers a camera sees, from geometry alone. The scene must outlive it.
class Visibility {
 public:
  explicit Visibility(const Scene& scene, const VisibilityLimits& limits = {});

  /// By rising id. Facing the camera, large enough, wholly in the image, no corner and no centre
  /// occluded.
  [[nodiscard]] std::vector<VisibleMarker> visible_from(const CameraModel& camera,
                                                        const Rigid3& world_from_cam) const;

 private:
  [[nodiscard]] bool sees(const CameraModel& camera, const Rigid3& world_from_cam,
                          const Occluders& occluders, const PlacedMarker& marker,
                          ImageCorners& corners) const;

  const Scene& scene_;
  VisibilityLimits limits_;
  double largest_marker_m_ = 0;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> markers_by_square_;
};

}  // namespace waymark::simulator
