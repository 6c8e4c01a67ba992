#include "simulator/capture_output.h"

#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>

#include "core/base/atomic_file.h"
#include "core/camera/kalibr.h"
#include "core/camera/rig_parameters.h"
#include "core/geometry/tum.h"

namespace waymark::simulator {
namespace {

namespace fs = std::filesystem;

/// As the path would be written without "." and a trailing slash.
fs::path cleaned(const fs::path& path) {
  std::error_code failed;
  const fs::path absolute = fs::absolute(path, failed);
  const fs::path normal = (failed ? path : absolute).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

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

Status create_folder(const fs::path& path) {
  std::error_code error;
  if (fs::create_directory(path, error) || !error) return {};
  const bool denied =
      error == std::errc::permission_denied || error == std::errc::read_only_file_system;
  return fail(denied ? ErrorKind::permission : ErrorKind::cant_create,
              "{}: can't create folder: {}", path.string(), error.message());
}

Expected<CaptureOutput> CaptureOutput::begin(const fs::path& final_path) {
  std::error_code ignored;
  const fs::path place = cleaned(final_path);
  if (fs::exists(place, ignored) &&
      !(fs::is_directory(place, ignored) && fs::is_empty(place, ignored))) {
    return fail(ErrorKind::cant_create,
                "{}: exists already; name another folder or remove this one first",
                final_path.string());
  }
  if (!fs::is_directory(place.parent_path(), ignored)) {
    return fail(ErrorKind::cant_create, "{}: can't create: there is no folder {}",
                final_path.string(), place.parent_path().string());
  }
  const fs::path growing =
      place.parent_path() / fmt::format(".{}.{}.partial", place.filename().string(), ::getpid());
  if (auto status = create_folder(growing); !status) return tl::make_unexpected(status.error());
  return CaptureOutput(place, growing);
}

CaptureOutput::CaptureOutput(CaptureOutput&& other) noexcept
    : final_path_(std::move(other.final_path_)), folder_(std::move(other.folder_)) {
  other.folder_.clear();
}

CaptureOutput::~CaptureOutput() {
  if (folder_.empty()) return;
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

Status CaptureOutput::write_description(const Scene& scene, const SimulatedRig& rig,
                                        const CapturePlan& plan, double exposure_s,
                                        const std::string& session) const {
  const Rig told = stated_exact(rig.mono ? without_places(rig.rig) : rig.rig);
  if (auto status = create_folder(folder_ / "groundtruth"); !status) return status;
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
    if (auto status = write_file_atomically(folder_ / name, text); !status) return status;
  }
  return {};
}

Status CaptureOutput::finish() {
  std::error_code error;
  fs::rename(folder_, final_path_, error);
  if (error) {
    return fail(ErrorKind::cant_create, "{}: can't move the finished capture here: {}",
                final_path_.string(), error.message());
  }
  folder_.clear();
  return {};
}

}  // namespace waymark::simulator
