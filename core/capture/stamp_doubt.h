#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/capture/frame_set.h"

namespace waymark {

/// What numbers that ought to be stamps in ns look like instead, for a message: "the stamps look
/// like µs (…)", seconds, ms, frame numbers, stamps of which some are 0; nullopt where nothing
/// speaks against them. Judged by the whole set: how far apart one camera's images lie, and how
/// large the numbers are. No camera takes 10,000 images a second. `monotonic`: the capture states
/// that its clock counts from a machine's start, so that small numbers are right.
[[nodiscard]] std::optional<std::string> doubt_of_stamps(std::span<const StampedImage> images,
                                                         bool monotonic = false);

/// Why the stamps can't be of one capture: from first to last more than 146 years, so that neither
/// clock nor difference would hold them. nullopt where they can.
[[nodiscard]] std::optional<std::string> doubt_of_span(std::span<const StampedImage> images);

}  // namespace waymark
