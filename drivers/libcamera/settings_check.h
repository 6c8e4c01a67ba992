#pragma once

#include <libcamera/controls.h>

#include "core/base/error.h"
#include "drivers/camera_options.h"

namespace waymark {

/// Whether a camera has taken what it was set to, by what its frames' metadata tell: libcamera
/// clamps without a word what does not go together, such as an exposure longer than a period.
class SettingsCheck {
 public:
  /// Settings take effect a few frames late: those that were under way, and two or three that the
  /// sensor takes (8–64 frames).
  static constexpr int kLatest = 16;

  /// A stream begins.
  void begin() { unlike_ = 0; }

  /// Whether a frame is as `wanted` as far as its `metadata` tell; false: not yet, so it is not to
  /// be used. Errors: config when it is the kLatest-th that is not.
  [[nodiscard]] Expected<bool> look(const libcamera::ControlList& metadata,
                                    const CameraOptions& wanted);

 private:
  int unlike_ = 0;  ///< frames so far
};

}  // namespace waymark
