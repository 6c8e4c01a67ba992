#include "locd/pose/pose_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "locd/frames/frame_synchronizer.h"

namespace waymark {
namespace {

using std::chrono::milliseconds;

/// One of an earlier set, every field with a value.
PoseEstimate of_an_earlier_set() {
  PoseEstimate estimate;
  estimate.sequence = 41;
  estimate.stamp = milliseconds(1000);
  estimate.set_stamp = milliseconds(1001);
  estimate.status = PoseStatus::ok;
  estimate.world_from_rig.translation.setOnes();
  estimate.covariance.setIdentity();
  estimate.velocity.setOnes();
  estimate.cameras_expected = estimate.cameras_in_set = estimate.cameras_used = 7;
  estimate.markers_seen = estimate.markers_used = estimate.observations_used = 9;
  estimate.outliers = 2;
  estimate.rms_px = 0.3;
  estimate.max_skew = milliseconds(3);
  estimate.camera_offset.fill(milliseconds(2));
  estimate.observations.resize(11);
  estimate.times = {milliseconds(4), milliseconds(5), milliseconds(6)};
  return estimate;
}

void expect_no_pose(const PoseEstimate& estimate, PoseReason why) {
  EXPECT_EQ(estimate.status, PoseStatus::lost);
  EXPECT_EQ(estimate.reasons, bit(why));
  EXPECT_TRUE(estimate.world_from_rig.translation.array().isNaN().all());
  EXPECT_TRUE(estimate.covariance.array().isNaN().all());
  EXPECT_TRUE(estimate.velocity.array().isNaN().all());
  EXPECT_TRUE(std::isnan(estimate.rms_px));
  EXPECT_EQ(estimate.cameras_used, 0U);
  EXPECT_EQ(estimate.markers_used, 0);
  EXPECT_EQ(estimate.observations_used, 0);
  EXPECT_EQ(estimate.outliers, 0);
}

void expect_nothing_observed(const PoseEstimate& estimate) {
  EXPECT_TRUE(estimate.observations.empty());
  EXPECT_EQ(estimate.markers_seen, 0);
  EXPECT_EQ(estimate.times.detect + estimate.times.solve + estimate.times.watch, Stamp{0});
}

TEST(PoseEstimate, ResetLeavesNothingOfAnEarlierSet) {
  PoseEstimate estimate = of_an_earlier_set();
  estimate.reset(PoseReason::no_frames);
  expect_no_pose(estimate, PoseReason::no_frames);
  expect_nothing_observed(estimate);
  EXPECT_EQ(estimate.sequence, 0U);
  EXPECT_EQ(estimate.stamp, Stamp{0});
  EXPECT_EQ(estimate.set_stamp, Stamp{0});
  EXPECT_EQ(estimate.max_skew, Stamp{0});
  EXPECT_EQ(estimate.cameras_expected, 0U);
  EXPECT_EQ(estimate.cameras_in_set, 0U);
  for (const Stamp offset : estimate.camera_offset) EXPECT_EQ(offset, Stamp{0});
}

TEST(PoseEstimate, OfASetThatWasNotLocalizedItKnowsNumberStampsAndCameras) {
  FrameSetLease set;
  set.sequence = 42;
  set.expected = 7;
  for (const std::size_t camera : {0U, 2U}) {
    FrameInfo info;
    info.stamp = milliseconds(camera == 0 ? 2000 : 2010);
    set.frames[camera] = Frame(info, {}, nullptr, nullptr, 0);
    set.cameras |= camera_bit(camera);
  }
  PoseEstimate estimate = of_an_earlier_set();
  estimate.reset(PoseReason::overload, set);
  expect_no_pose(estimate, PoseReason::overload);
  expect_nothing_observed(estimate);
  EXPECT_EQ(estimate.sequence, 42U);
  EXPECT_EQ(estimate.stamp, milliseconds(2005));
  EXPECT_EQ(estimate.set_stamp, milliseconds(2000));
  EXPECT_EQ(estimate.max_skew, milliseconds(10));
  EXPECT_EQ(estimate.cameras_expected, 7U);
  EXPECT_EQ(estimate.cameras_in_set, 5U);
  EXPECT_EQ(estimate.camera_offset[0], milliseconds(-5));
  EXPECT_EQ(estimate.camera_offset[1], Stamp{0});
  EXPECT_EQ(estimate.camera_offset[2], milliseconds(5));
}

TEST(PoseEstimate, WithoutAPoseWhatWasObservedStays) {
  PoseEstimate estimate = of_an_earlier_set();
  estimate.lose_pose(PoseReason::no_solution);
  expect_no_pose(estimate, PoseReason::no_solution);
  EXPECT_EQ(estimate.observations.size(), 11U);
  EXPECT_EQ(estimate.markers_seen, 9);
  EXPECT_EQ(estimate.sequence, 41U);
}

TEST(PoseReason, EveryOneHasANameOfItsOwn) {
  std::set<std::string_view> names;
  for (std::size_t r = 0; r < kPoseReasons; ++r) {
    names.insert(name_of(static_cast<PoseReason>(1U << r)));
  }
  EXPECT_EQ(names.size(), kPoseReasons);
  EXPECT_EQ(name_of(PoseReason::overload), "OVERLOAD");
  EXPECT_EQ(name_of(PoseReason::protection), "PROTECTION");
  EXPECT_EQ(bit(PoseReason::protection), 1U << (kPoseReasons - 1)) << "it is the last";
}

}  // namespace
}  // namespace waymark
