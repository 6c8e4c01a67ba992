#pragma once

#include <string>

#include "core/base/range.h"
#include "core/camera/rig.h"
#include "core/geometry/stamp.h"
#include "drivers/camera_controls.h"
#include "drivers/pixel_format.h"

namespace waymark {

/// What a camera shall deliver.
struct CaptureRequest {
  int width_px = 0;
  int height_px = 0;
  const PixelFormat* pixels = nullptr;  ///< null: the best that the device offers
  double fps = 0;                       ///< 1/s; 0: what the device does

  static constexpr Range kFps{0, 1000};
};

/// Two frame rates that differ by less are the same, for devices round periods (0.01–2 %).
inline constexpr double kSameRate = 0.01;

/// Which camera is meant: by a stable name, or by serial number and place on the bus. Never by a
/// number: those change with the order in which cameras are plugged in.
struct DeviceIdentity {
  std::string path;    ///< /dev/v4l/by-id/…, or any link that the system keeps up
  std::string serial;  ///< else both or one of these
  std::string bus;

  [[nodiscard]] std::string text() const;
};

/// One camera of the rig, whatever its driver.
struct CameraOptions {
  std::string name;  ///< in the rig
  DeviceIdentity device;
  std::string serial;  ///< that rig.yaml states; empty: any
  CaptureRequest request;
  CameraControls controls;
  Stamp readout{0};  ///< rolling shutter, first to last row; in RigCamera::kReadout_us

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

}  // namespace waymark
