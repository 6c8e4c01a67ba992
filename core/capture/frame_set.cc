#include "core/capture/frame_set.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <set>

#include "core/base/check.h"

namespace waymark {
namespace {

/// Indices of the images by rising (stamp, camera).
std::vector<std::size_t> by_stamp_then_camera(std::span<const StampedImage> images) {
  std::vector<std::size_t> order(images.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (images[a].stamp != images[b].stamp) return images[a].stamp < images[b].stamp;
    return images[a].camera < images[b].camera;
  });
  return order;
}

}  // namespace

std::vector<FrameSet> group_into_frame_sets(std::span<const StampedImage> images, Stamp tolerance) {
  WAYMARK_CHECK(tolerance >= Stamp::zero());
  const std::vector<std::size_t> order = by_stamp_then_camera(images);
  std::vector<bool> taken(images.size(), false);
  std::vector<FrameSet> sets;
  for (auto first = order.begin(); first != order.end(); ++first) {
    if (taken[*first]) continue;
    FrameSet set;
    std::set<int> cameras;
    for (auto next = first; next != order.end() &&
                            time_between(images[*first].stamp, images[*next].stamp) <= tolerance;
         ++next) {
      if (taken[*next] || !cameras.insert(images[*next].camera).second) continue;
      taken[*next] = true;
      set.images.push_back(*next);
    }
    std::sort(set.images.begin(), set.images.end(),
              [&](std::size_t a, std::size_t b) { return images[a].camera < images[b].camera; });
    set.stamp = images[set.images.front()].stamp;
    sets.push_back(std::move(set));
  }
  // A set's own stamp may be later than its earliest image's, and later than the next set's.
  std::stable_sort(sets.begin(), sets.end(),
                   [](const FrameSet& a, const FrameSet& b) { return a.stamp < b.stamp; });
  return sets;
}

std::vector<FrameSet> one_frame_set_per_image(std::span<const StampedImage> images) {
  std::vector<FrameSet> sets;
  sets.reserve(images.size());
  for (const std::size_t image : by_stamp_then_camera(images)) {
    sets.push_back({images[image].stamp, {image}});
  }
  return sets;
}

}  // namespace waymark
