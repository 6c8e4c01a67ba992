#include "locd/publish/status_text.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

PoseEstimate good() {
  PoseEstimate e;
  e.status = PoseStatus::ok;
  e.covariance = Matrix6d::Identity() * 9e-6;
  e.cameras_expected = e.cameras_in_set = 0b111;
  e.markers_used = 14;
  e.observations_used = 20;
  return e;
}

std::string text_of(const PoseEstimate& estimate) {
  std::string text;
  write_status_text(estimate, text);
  return text;
}

TEST(StatusText, OfAGoodPoseSaysWhatItRestsOnAndHowSureItIs) {
  EXPECT_EQ(text_of(good()), "OK, 14 markers, 3 mm");
}

TEST(StatusText, SaysEveryReasonInWords) {
  PoseEstimate e = good();
  e.status = PoseStatus::degraded;
  e.cameras_in_set = 0b101;
  e.reasons = bit(PoseReason::camera_missing);
  EXPECT_EQ(text_of(e), "DEGRADED: cam1 missing");
  e.reasons |= bit(PoseReason::sigma) | bit(PoseReason::outliers);
  e.outliers = 5;
  EXPECT_EQ(
      text_of(e),
      "DEGRADED: sure to 3 mm and 0.17 deg only, cam1 missing, 5 of 25 observations disagree");
  e.lose_pose(PoseReason::no_markers);
  EXPECT_EQ(text_of(e), "LOST: no mapped marker seen");
}

TEST(StatusText, NeverNeedsMoreRoomThanItSays) {
  PoseEstimate e = good();
  e.status = PoseStatus::degraded;
  e.cameras_expected = 0xFFFF;
  e.cameras_in_set = 0;
  e.reasons = (1U << kPoseReasons) - 1;
  EXPECT_LT(text_of(e).size(), kMostStatusText);
}

}  // namespace
}  // namespace waymark
