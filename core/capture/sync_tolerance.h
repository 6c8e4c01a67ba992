#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/capture/frame_set.h"

namespace waymark {

/// Times between the images of each camera that follow each other, of all cameras together; images
/// of one camera with one stamp count once.
[[nodiscard]] std::vector<Stamp> spacings_of(std::span<const StampedImage> images);

/// A sync tolerance that pairs rightly, and what to tell of it.
struct UsableTolerance {
  Stamp tolerance;
  std::optional<std::string> note;  ///< where it is less than what was stated
};

/// Of a stated tolerance at most (n − 1)/n of the n cameras' period: that gives whole sets at any
/// phase of cameras that run free. Of a larger one a single lost frame would pair all that follow
/// with their neighbours' next ones, and nothing would tell.
[[nodiscard]] UsableTolerance usable_tolerance(Stamp stated, Stamp period, std::size_t cameras);

/// The same where the images' stamps tell the period: the median of their spacings.
[[nodiscard]] UsableTolerance usable_tolerance(Stamp stated, std::span<const StampedImage> images,
                                               std::size_t cameras);

}  // namespace waymark
