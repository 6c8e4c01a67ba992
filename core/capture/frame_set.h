#pragma once

#include <chrono>
#include <cstddef>
#include <span>
#include <vector>

#include "core/base/range.h"
#include "core/geometry/stamp.h"

namespace waymark {

/// One image as the grouping sees it.
struct StampedImage {
  int camera = 0;
  Stamp stamp{0};
};

/// Images of one instant, at most one per camera.
struct FrameSet {
  Stamp stamp{0};                   ///< of its lowest-numbered camera's image
  std::vector<std::size_t> images;  ///< indices into the input, by rising camera
};

/// What a sync tolerance may be: a larger one would join frames of different places, at 1 m/s 1 m
/// apart.
inline constexpr Range kSyncTolerance_us{0, 1e6};
/// Default sync tolerance: frames within 5 ms of the set's earliest belong together.
inline constexpr Stamp kDefaultSyncTolerance = std::chrono::milliseconds(5);

/// Groups images into frame sets, by rising stamp: a set starts with the earliest image left and
/// takes, per camera, the earliest one within `tolerance` of it. Pure; the input's order does not
/// matter.
[[nodiscard]] std::vector<FrameSet> group_into_frame_sets(std::span<const StampedImage> images,
                                                          Stamp tolerance = kDefaultSyncTolerance);

/// Every image a frame set of its own (mono mapping), by rising (stamp, camera).
[[nodiscard]] std::vector<FrameSet> one_frame_set_per_image(std::span<const StampedImage> images);

}  // namespace waymark
