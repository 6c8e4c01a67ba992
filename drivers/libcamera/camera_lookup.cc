#include "drivers/libcamera/camera_lookup.h"

#include <libcamera/logging.h>
#include <libcamera/property_ids.h>
#include <sys/stat.h>

#include <mutex>
#include <system_error>

#include "drivers/libcamera/camera_settings.h"
#include "drivers/libcamera/libcamera_source.h"
#include "drivers/v4l2/capture_capability.h"

namespace waymark {

std::string reason(int negative_errno) {
  return std::error_code(-negative_errno, std::generic_category()).message();
}

namespace {

std::mutex manager_mutex;  ///< of its making and its end, for there must never be two of them
std::weak_ptr<libcamera::CameraManager> current;

}  // namespace

void let_go(std::shared_ptr<libcamera::CameraManager>& manager) {
  const std::lock_guard lock(manager_mutex);
  manager.reset();
}

Expected<std::shared_ptr<libcamera::CameraManager>> shared_manager() {
  const std::lock_guard lock(manager_mutex);
  if (auto running = current.lock()) return running;
  // Its own log knows no bounds. Levels would need the name of every category; our errors say what
  // matters.
  libcamera::logSetTarget(libcamera::LoggingTargetNone);
  auto manager = std::make_shared<libcamera::CameraManager>();
  if (const int failed = manager->start(); failed < 0) {
    return fail(ErrorKind::unavailable, "libcamera can't start: {}", reason(failed));
  }
  current = manager;
  return manager;
}

std::shared_ptr<libcamera::Camera> camera_of(libcamera::CameraManager& manager,
                                             const std::string& node) {
  struct stat info {};
  return ::stat(node.c_str(), &info) == 0 ? manager.get(info.st_rdev) : nullptr;
}

std::string model_of(const libcamera::Camera& camera) {
  return camera.properties().get(libcamera::properties::Model).value_or("no model");
}

std::string capture_node_of(const std::shared_ptr<libcamera::Camera>& camera,
                            libcamera::CameraManager& manager, VideoSystem& system) {
  for (const VideoDevice& device : system.nodes()) {
    if (camera_of(manager, device.node) != camera) continue;
    const auto node = system.open(device.node);
    const auto can = node ? capture_capability(**node) : tl::make_unexpected(node.error());
    if (can && can->streams()) return device.node;
  }
  return {};
}

}  // namespace waymark

void waymark_list_libcamera_cameras(waymark::VideoSystem& system,
                                    std::vector<waymark::LibcameraCamera>& result) {
  const auto manager = waymark::shared_manager();
  if (!manager) return;
  for (const auto& camera : (*manager)->cameras()) {
    waymark::LibcameraCamera listed;
    listed.id = camera->id();
    listed.model = waymark::model_of(*camera);
    listed.offered = waymark::offered_formats(*camera);
    listed.understood = waymark::understood_formats(*camera);
    for (const waymark::VideoDevice& device : system.nodes()) {
      if (waymark::camera_of(**manager, device.node) == camera) listed.nodes.push_back(device.node);
    }
    result.push_back(std::move(listed));
  }
}
