#include "locd/pose/robust_pose.h"

#include <gtest/gtest.h>

#include "tests/support/expect_ranges.h"

namespace waymark {
namespace {

TEST(RobustPoseOptions, AreHeldToTheirRanges) {
  using Options = RobustPoseOptions;
  expect_ranges<Options>(
      {ranged("inlier_sigmas", &Options::inlier_sigmas, {4, 20}),
       ranged("tukey_sigmas", &Options::tukey_sigmas, {6, 40}),
       ranged("seed_observations", &Options::seed_observations, {1, 64}),
       ranged("all_seed_observations", &Options::all_seed_observations, {1, 512})});
}

}  // namespace
}  // namespace waymark
