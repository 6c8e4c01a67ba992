#include "mapbuilder/calibrate/calibrated_cameras.h"

#include <algorithm>

#include "core/camera/rig_parameters.h"

namespace waymark {
namespace {

bool are_alike(const CameraParameters& a, const CameraParameters& b) {
  return a.width_px == b.width_px && a.height_px == b.height_px;
}

}  // namespace

Expected<std::vector<DetectedCapture>> with_common_rig(std::vector<DetectedCapture> captures) {
  const auto most = std::max_element(captures.begin(), captures.end(),
                                     [](const DetectedCapture& a, const DetectedCapture& b) {
                                       return a.rig.cameras.size() < b.rig.cameras.size();
                                     });
  if (most == captures.end()) return captures;
  const Rig rig = most->rig;
  const std::string name = most->name;
  for (const DetectedCapture& capture : captures) {
    for (std::size_t k = 0; k < capture.rig.cameras.size(); ++k) {
      const CameraParameters& here = capture.rig.cameras[k].model.parameters();
      const CameraParameters& there = rig.cameras[k].model.parameters();
      if (are_alike(here, there)) continue;
      return fail(ErrorKind::bad_data,
                  "{}: {} has images of {}×{}, in {} of {}×{}: another camera; calibrate each rig "
                  "by its own captures",
                  capture.name, rig.cameras[k].name, here.width_px, here.height_px, name,
                  there.width_px, there.height_px);
    }
  }
  return with_rig(std::move(captures), rig);
}

std::vector<DetectedCapture> captures_of_camera(const std::vector<DetectedCapture>& captures,
                                                std::size_t camera) {
  std::vector<DetectedCapture> alone;
  for (const DetectedCapture& capture : captures) {
    DetectedCapture one = capture;
    one.rig = single_camera_rig(capture.rig, camera);
    std::erase_if(one.images, [&](const ImageDetections& image) {
      return image.camera != static_cast<int>(camera);
    });
    for (ImageDetections& image : one.images) image.camera = 0;
    const bool sees = std::any_of(one.images.begin(), one.images.end(),
                                  [](const auto& image) { return !image.detections.empty(); });
    if (sees) alone.push_back(std::move(one));
  }
  return alone;
}

std::vector<DetectedCapture> with_rig(std::vector<DetectedCapture> captures, const Rig& rig) {
  for (DetectedCapture& capture : captures) capture.rig = rig;
  return captures;
}

std::array<std::vector<DetectedCapture>, 2> halves_of(
    const std::vector<DetectedCapture>& captures) {
  constexpr std::size_t kBlocks = 8;
  std::array<std::vector<DetectedCapture>, 2> halves;
  for (const DetectedCapture& capture : captures) {
    std::array<DetectedCapture, 2> parts{capture, capture};
    for (DetectedCapture& part : parts) part.images.clear();
    std::vector<StampedImage> stamped;
    for (const ImageDetections& image : capture.images) {
      stamped.push_back({image.camera, image.stamp});
    }
    const auto sets = group_into_frame_sets(stamped, capture.sync_tolerance);
    for (std::size_t s = 0; s < sets.size(); ++s) {
      DetectedCapture& part = parts[(s * kBlocks / sets.size()) % 2];
      for (const std::size_t i : sets[s].images) part.images.push_back(capture.images[i]);
    }
    for (std::size_t half = 0; half < 2; ++half) halves[half].push_back(std::move(parts[half]));
  }
  return halves;
}

}  // namespace waymark
