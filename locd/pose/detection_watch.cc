#include "locd/pose/detection_watch.h"

namespace waymark {

void DetectionWatch::look(CameraMask searched, CameraMask failed, Stamp stamp,
                          std::vector<Alert>& alerts) {
  for (std::size_t c = 0; c < kMaxCameras; ++c) {
    if ((searched & camera_bit(c)) == 0) continue;
    Camera& camera = cameras_[c];
    const bool fails = (failed & camera_bit(c)) != 0;
    camera.sets_otherwise = fails == camera.raised ? 0 : camera.sets_otherwise + 1;
    if (camera.sets_otherwise < kSets) continue;
    camera = {fails, 0};
    Alert alert;
    alert.kind = AlertKind::image_unsearched;
    alert.raised = fails;
    alert.stamp = stamp;
    alert.camera = static_cast<int>(c);
    alerts.push_back(alert);
  }
}

}  // namespace waymark
