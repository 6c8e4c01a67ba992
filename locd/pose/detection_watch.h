#pragma once

#include <array>
#include <vector>

#include "locd/alert.h"
#include "locd/camera_mask.h"

namespace waymark {

/// Tells when a camera's images can't be searched for markers any more, because the library that
/// finds them fails on each, and when they can again. No allocation while `alerts` has room.
class DetectionWatch {
 public:
  /// Sets in a row that raise the alert, or end it: one damaged image is no lasting fault. (2–100)
  static constexpr int kSets = 3;

  /// Looks at a set of `stamp`: of the cameras `searched`, those that `failed`.
  void look(CameraMask searched, CameraMask failed, Stamp stamp, std::vector<Alert>& alerts);

 private:
  struct Camera {
    bool raised = false;
    int sets_otherwise = 0;  ///< in a row, that speak against `raised`
  };
  std::array<Camera, kMaxCameras> cameras_;
};

}  // namespace waymark
