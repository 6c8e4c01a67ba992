#include "drivers/v4l2/buffer_stamp.h"

#include <linux/videodev2.h>

namespace waymark {
namespace {

/// 126 years, either way; a Stamp holds 292 (1e9–9e9).
constexpr std::int64_t kMost_s = 4'000'000'000;

}  // namespace

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

Stamp buffer_stamp(const timeval& timestamp) {
  const bool is_time = timestamp.tv_sec >= -kMost_s && timestamp.tv_sec <= kMost_s &&
                       timestamp.tv_usec >= 0 && timestamp.tv_usec < 1'000'000;
  if (!is_time) return Stamp{0};
  return std::chrono::seconds(timestamp.tv_sec) + std::chrono::microseconds(timestamp.tv_usec);
}

}  // namespace waymark
