#pragma once

#include <array>
#include <cstdint>

#include "core/geometry/stamp.h"
#include "locd/camera_mask.h"
#include "locd/frames/frame_synchronizer.h"

namespace waymark {

/// What the localization thread has done since the start; what a status message says of it.
struct LocalizationCounts {
  std::uint64_t sets = 0;     ///< taken from the cameras
  std::uint64_t late = 0;     ///< older than the time budget
  std::uint64_t skipped = 0;  ///< by the even thinning
  std::uint64_t alerts_lost = 0;
  int divisor = 1;  ///< every divisor-th set is localized
  /// Time of the last loop iteration: a set done, or a wait without one. The watchdog is fed only
  /// while it advances.
  Stamp last_turn{0};
  bool at_work = false;                    ///< a set was taken and is not done
  Stamp passed_over{0};                    ///< when a set last went without a pose of its own
  CameraMask unhealthy = 0;                ///< cameras whose images can't be used
  std::array<int, kMaxCameras> markers{};  ///< per camera, in its image of the last set
  /// Per camera: frames that came into a set and not into its pose, by reason.
  std::array<DropCounts, kMaxCameras> left_out{};
};

}  // namespace waymark
