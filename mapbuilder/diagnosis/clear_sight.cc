#include "mapbuilder/diagnosis/clear_sight.h"

#include <algorithm>
#include <cmath>

#include "core/marker/marker_outline.h"

namespace waymark {
namespace {

/// Where a camera would show the place's corners; nullopt unless whole, from the front, within 60°.
std::optional<ImageCorners> image_of(const CameraModel& model, const Rigid3& cam_from_marker,
                                     double size_m) {
  constexpr double kLeastCosine = 0.5;
  const Eigen::Vector3d towards_camera = -cam_from_marker.translation.normalized();
  if ((cam_from_marker.rotation * Eigen::Vector3d::UnitZ()).dot(towards_camera) < kLeastCosine) {
    return std::nullopt;
  }
  ImageCorners corners;
  const auto in_marker = marker_corners(size_m);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = model.project(cam_from_marker * in_marker[i]);
    if (!pixel || !model.in_image(*pixel)) return std::nullopt;
    corners[i] = *pixel;
  }
  return corners;
}

}  // namespace

bool has_clear_sight(const MapEvidence& evidence, FrameSetIndex frame_set, const SizedPlace& place,
                     double least_side_px) {
  constexpr double kBeside = 4.0;      // sides
  constexpr double kLeastDepth = 0.8;  // of the place's: a wall in between would hide both
  constexpr double kMargin = 0.25;     // sides to the image's edge: paper is part of a marker
  const auto& world_from_rig = evidence.world_from_rig(frame_set);
  if (!world_from_rig) return false;
  const auto seen = evidence.seen_in(frame_set);
  const Rig& rig = evidence.rig_of(frame_set);
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const CameraModel& model = rig.cameras[c].model;
    const Rigid3 cam_from_marker =
        (*world_from_rig * rig.cameras[c].rig_from_cam).inverse() * place.world_from_marker;
    if (!image_of(model, cam_from_marker, (1.0 + 2.0 * kMargin) * place.size_m)) continue;
    const auto corners = image_of(model, cam_from_marker, place.size_m);
    if (!corners) continue;
    const double side = std::sqrt(area_px2(*corners));
    if (side < least_side_px) continue;
    const bool proven = std::any_of(seen.begin(), seen.end(), [&](const MarkerObservation* o) {
      return o->camera == static_cast<int>(c) && o->ippe &&
             (centre_of(o->corners_px) - centre_of(*corners)).norm() < kBeside * side &&
             o->ippe->cam_from_marker[0].translation.norm() >
                 kLeastDepth * cam_from_marker.translation.norm();
    });
    if (proven) return true;
  }
  return false;
}

}  // namespace waymark
