#pragma once

#include <cstdint>

#include "drivers/mid_exposure.h"

namespace waymark {

/// What the time stamp of a v4l2_buffer with these flags means.
[[nodiscard]] StampMeaning stamp_meaning(std::uint32_t buffer_flags);

}  // namespace waymark
