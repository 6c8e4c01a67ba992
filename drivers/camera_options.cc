#include "drivers/camera_options.h"

namespace waymark {
namespace {

/// An absent control lies in every range.
double or_lowest(const std::optional<double>& value, const Range& range) {
  return value.value_or(range.low);
}

}  // namespace

Status CameraControls::check() const {
  if (power_line_hz && !is_power_line_hz(*power_line_hz)) {
    return fail(ErrorKind::usage, "power_line_hz is {}; it must be 0 (off), 50 or 60",
                *power_line_hz);
  }
  return RangeCheck()
      .field("exposure_us", or_lowest(exposure_us, kExposure_us), kExposure_us)
      .field("gain", or_lowest(gain, kGain), kGain)
      .field("white_balance_k", or_lowest(white_balance_k, kWhiteBalance_k), kWhiteBalance_k)
      .field("focus", or_lowest(focus, kFocus), kFocus)
      .status();
}

Status CameraOptions::check() const {
  return RangeCheck()
      .field("request.fps", request.fps, CaptureRequest::kFps)
      .part("controls", controls.check())
      .field("readout in us", in_us(readout), RigCamera::kReadout_us)
      .status();
}

}  // namespace waymark
