#include "simulator/capture_output.h"

#include <cmath>

#include "core/base/atomic_file.h"
#include "core/base/growing_folder.h"
#include "core/camera/kalibr.h"
#include "core/camera/rig_parameters.h"
#include "core/geometry/tum.h"

namespace waymark::simulator {
namespace {

namespace fs = std::filesystem;

std::vector<TumPose> rig_truth(const CapturePlan& plan) {
  std::vector<TumPose> poses;
  for (const Exposure& exposure : plan.exposures()) {
    if (exposure.camera == 0) {
      poses.push_back({format_stamp_s(exposure.stamp), plan.world_from_rig(exposure)});
    }
  }
  return poses;
}

std::vector<TumPose> camera_truth(const CapturePlan& plan, std::size_t camera) {
  std::vector<TumPose> poses;
  for (const Exposure& exposure : plan.exposures()) {
    if (exposure.camera == camera) {
      poses.push_back({format_stamp_s(exposure.stamp), plan.world_from_cam(exposure)});
    }
  }
  return poses;
}

std::vector<TumPose> marker_truth(const Scene& scene) {
  std::vector<TumPose> poses;
  for (const PlacedMarker& marker : scene.markers) {
    poses.push_back({scene.catalog.format(marker.id), marker.world_from_marker});
  }
  return poses;
}

std::string frames_csv(const SimulatedRig& rig, const CapturePlan& plan, double exposure_s) {
  std::string text = "camera,t_ns,exposure_ns,sequence,stamp_quality\n";
  for (const Exposure& exposure : plan.exposures()) {
    fmt::format_to(std::back_inserter(text), "{},{},{},{},exact\n",
                   rig.rig.cameras[exposure.camera].name, exposure.stamp.count(),
                   std::llround(exposure_s * 1e9), exposure.position);
  }
  return text;
}

/// The rig as the file of one without transforms tells it: each camera is a frame of its own.
Rig without_places(Rig rig) {
  rig.has_extrinsics = false;
  for (RigCamera& camera : rig.cameras) camera.rig_from_cam = Rigid3{};
  return rig;
}

}  // namespace

Status write_description(const fs::path& folder, const Scene& scene, const SimulatedRig& rig,
                         const CapturePlan& plan, double exposure_s, const std::string& session) {
  const Rig told = stated_exact(rig.mono ? without_places(rig.rig) : rig.rig);
  if (auto status = create_folder(folder / "groundtruth"); !status) return status;
  const std::string capture_toml = fmt::format(
      "clock = \"realtime\"\nsession = \"{}\"\nsoftware = \"waymark simulator\"\n", session);
  std::vector<std::pair<std::string, std::string>> files = {
      {"rig.yaml", format_camchain(told)},
      {"markers.toml", format_marker_catalog(scene.catalog.with_exact_sizes())},
      {"capture.toml", capture_toml},
      {"frames.csv", frames_csv(rig, plan, exposure_s)},
      {"groundtruth/rig.tum", format_tum(rig_truth(plan))},
      {"groundtruth/markers.tum", format_tum(marker_truth(scene))}};
  if (rig.mono) {
    for (std::size_t camera = 0; camera < told.cameras.size(); ++camera) {
      files.emplace_back(fmt::format("groundtruth/rig.{}.tum", told.cameras[camera].name),
                         format_tum(camera_truth(plan, camera)));
    }
  }
  for (const auto& [name, text] : files) {
    if (auto status = write_file_atomically(folder / name, text); !status) return status;
  }
  return {};
}

}  // namespace waymark::simulator
