#include "drivers/v4l2/buffer_stamp.h"

#include <linux/videodev2.h>

namespace waymark {

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

}  // namespace waymark
