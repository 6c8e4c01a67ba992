#pragma once

#include <chrono>

namespace waymark {

/// Mid-exposure time of a frame, in ns since any epoch; one clock for all cameras of a capture.
using Stamp = std::chrono::nanoseconds;

}  // namespace waymark
