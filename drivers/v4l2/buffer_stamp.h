#pragma once

#include <sys/time.h>

#include <cstdint>

#include "drivers/mid_exposure.h"

namespace waymark {

/// What the time stamp of a v4l2_buffer with these flags means.
[[nodiscard]] StampMeaning stamp_meaning(std::uint32_t buffer_flags);

/// The time stamp of a v4l2_buffer; 0 for what no clock shows: v4l2loopback hands on whatever its
/// writer wrote.
[[nodiscard]] Stamp buffer_stamp(const timeval& timestamp);

}  // namespace waymark
