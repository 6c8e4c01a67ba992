#include "drivers/v4l2/buffer_stamp.h"

#include <linux/videodev2.h>

namespace waymark {

const char* name_of(StampMeaning meaning) {
  switch (meaning) {
    case StampMeaning::start_of_exposure:
      return "start of exposure";
    case StampMeaning::end_of_frame:
      return "end of frame";
    case StampMeaning::unknown:
      break;
  }
  return "unknown";
}

StampMeaning stamp_meaning(std::uint32_t buffer_flags) {
  // Copied stamps are those of whoever fed the device.
  if ((buffer_flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC) {
    return StampMeaning::unknown;
  }
  switch (buffer_flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) {
    case V4L2_BUF_FLAG_TSTAMP_SRC_SOE:
      return StampMeaning::start_of_exposure;
    case V4L2_BUF_FLAG_TSTAMP_SRC_EOF:
      return StampMeaning::end_of_frame;
    default:
      return StampMeaning::unknown;
  }
}

MidExposure mid_exposure(StampMeaning meaning, Stamp stamp, const ExposureTiming& timing) {
  if (meaning == StampMeaning::unknown || timing.exposure == Stamp{0}) {
    return {stamp, StampQuality::approximate};
  }
  const Stamp half = (timing.exposure + timing.readout) / 2;
  const bool starts = meaning == StampMeaning::start_of_exposure;
  return {starts ? stamp + half : stamp - half, StampQuality::exact};
}

}  // namespace waymark
