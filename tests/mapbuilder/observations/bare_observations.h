#pragma once

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "mapbuilder/observations/observations.h"

namespace waymark::test {

/// Bare observations (frame set, marker), rising.
inline Observations bare_observations(const std::vector<std::pair<std::size_t, std::size_t>>& pairs,
                                      std::size_t frame_sets, std::size_t markers) {
  Observations observations;
  observations.markers.resize(markers);
  observations.stated_sizes_m.resize(markers);
  std::vector<std::size_t> count(frame_sets, 0);
  for (const auto& [frame_set, marker] : pairs) {
    Observation o;
    o.covariances.fill(Eigen::Matrix2d::Zero());
    o.frame_set = FrameSetIndex(frame_set);
    o.marker = MarkerIndex(marker);
    o.corners_px = {{{0, 0}, {10.0 + static_cast<double>(marker), 0}, {10, 10}, {0, 10}}};
    observations.all.push_back(o);
    ++count[frame_set];
  }
  observations.usable = observations.all.size();
  std::size_t first = 0;
  for (const std::size_t own : count) {
    ObservedFrameSet set;
    set.observations = {first, own};
    observations.frame_sets.push_back(set);
    first += own;
  }
  return observations;
}

}  // namespace waymark::test
