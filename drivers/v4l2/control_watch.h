#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "drivers/v4l2/video_node.h"

namespace waymark {

/// A control that has been set, or found to be fixed, and what it must stay at.
struct HeldControl {
  std::uint32_t id = 0;
  int value = 0;
};

/// Sees to it that a camera stays as it was set, although others may open its device: stamps rest
/// on the exposure, the calibration on the focus. What somebody else has changed is told and set
/// again.
class ControlWatch {
 public:
  static constexpr Stamp kPeriod = std::chrono::seconds(1);

  void begin(std::vector<HeldControl> held, Stamp now);
  /// Once a period, reads them all. A control that can't be read tells nothing: a device that is
  /// gone is seen by its frames.
  void look(VideoNode& node, Stamp now);
  /// "exposure was set from 20 to 300 by another program; it is set again", until a look finds all
  /// as they were set; else empty.
  [[nodiscard]] const std::string& changed() const { return changed_; }

 private:
  std::vector<HeldControl> held_;
  Stamp due_{0};
  std::string changed_;
};

}  // namespace waymark
