// Finds a map's markers in one image and prints where the camera stood.
// Usage: localize_image MAP CAMCHAIN CAMERA IMAGE   (CAMERA: 0 for cam0 of the camchain)
//
// locd does far more: several cameras, motion, markers that were moved, sigmas that hold. A program
// that drives a vehicle should listen to locd.
#include <core/camera/kalibr.h>
#include <core/capture/image_file.h>
#include <core/detect/image_detector.h>
#include <core/estimate/rig_pose_solver.h>
#include <core/map/map_file.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>

namespace {

using Places = std::map<waymark::MarkerId, waymark::MapMarker>;

int end_with(const waymark::Error& error) {
  std::fprintf(stderr, "localize_image: %s\n", error.message.c_str());
  return error.exit_code();
}

/// The markers that the detector is to look for: those of the map, at the map's sizes.
waymark::MarkerCatalog catalog_of(const Places& places) {
  std::map<waymark::Family, waymark::MarkerCatalog::FamilyEntry> entries;
  for (const auto& [id, marker] : places) {
    waymark::MarkerCatalog::FamilyEntry& entry = entries[id.family];
    entry.family = id.family;
    entry.size_m_by_id[id.number] = marker.size_m;
  }
  std::vector<waymark::MarkerCatalog::FamilyEntry> list;
  for (auto& [family, entry] : entries) list.push_back(std::move(entry));
  return waymark::MarkerCatalog(std::move(list));
}

/// A detection, ready for estimation. `model_px` is what lens and print add to each corner's noise.
waymark::MarkerObservation observe(const waymark::Detection& detection, double size_m, int camera,
                                   const waymark::CameraModel& model, double model_px = 0.1) {
  waymark::MarkerObservation observation;
  observation.camera = camera;
  observation.size_m = size_m;
  observation.corners_px = detection.corners;
  for (std::size_t i = 0; i < 4; ++i) {
    Eigen::Matrix2d covariance = model_px * model_px * Eigen::Matrix2d::Identity();
    if (detection.covariances) covariance += (*detection.covariances)[i];
    observation.whitening[i] = waymark::whitening_from_covariance(covariance);
  }
  observation.ippe = waymark::solve_ippe(model, detection.corners, size_m);
  return observation;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fputs("usage: localize_image MAP CAMCHAIN CAMERA IMAGE\n", stderr);
    return 64;
  }
  const auto map = waymark::read_map_file(argv[1]);
  if (!map) return end_with(map.error());
  const auto loaded_rig = waymark::read_camchain(argv[2]);
  if (!loaded_rig) return end_with(loaded_rig.error());
  const waymark::Rig& rig = loaded_rig->rig;
  const int camera = std::atoi(argv[3]);
  if (camera < 0 || static_cast<std::size_t>(camera) >= rig.cameras.size()) {
    std::fprintf(stderr, "localize_image: %s has no camera %s\n", argv[2], argv[3]);
    return 64;
  }
  const waymark::CameraModel& model = rig.cameras[static_cast<std::size_t>(camera)].model;
  const auto image = waymark::read_gray_image(argv[4]);
  if (!image) return end_with(image.error());
  const waymark::GrayView view = image->image.view();
  if (view.width_px != model.parameters().width_px ||
      view.height_px != model.parameters().height_px) {
    std::fprintf(stderr, "localize_image: %s has another size than the camera\n", argv[4]);
    return 65;
  }

  // The first sub-map is the largest; each has a frame of its own.
  Places places;
  for (const waymark::MapMarker& marker : map->submaps.front().markers) places[marker.id] = marker;
  const waymark::MarkerCatalog catalog = catalog_of(places);
  waymark::ImageDetector detector(catalog);
  std::vector<waymark::MarkerObservation> observations;
  std::vector<waymark::FixedMarkerObservation> fixed;
  const auto& detections = detector.detect(view, model).detections;
  observations.reserve(detections.size());  // `fixed` points into it
  for (const waymark::Detection& detection : detections) {
    const waymark::MapMarker& marker = places.at(detection.marker);
    observations.push_back(observe(detection, marker.size_m, camera, model));
    fixed.push_back({&observations.back(), marker.world_from_marker});
  }

  waymark::RigPoseSolver solver(rig, {});
  const auto pose = solver.solve(fixed);
  if (!pose) {
    std::fprintf(stderr, "localize_image: %s: no pose from %zu markers of the map\n", argv[4],
                 detections.size());
    return 65;
  }
  const Eigen::Vector3d& x = pose->best.pose.translation;
  const Eigen::Quaterniond& q = pose->best.pose.rotation;
  std::printf("markers %zu\nposition_m %.6f %.6f %.6f\nquaternion_xyzw %.6f %.6f %.6f %.6f\n%s",
              detections.size(), x.x(), x.y(), x.z(), q.x(), q.y(), q.z(), q.w(),
              pose->ambiguous ? "ambiguous\n" : "");
  return 0;
}
