#include "mapbuilder/diagnosis/observation_findings.h"

#include <gtest/gtest.h>

#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

TEST(ObservationFindings, SayWhatWasLeftOutAndNothingElse) {
  Observations observations;
  EXPECT_TRUE(observation_findings(observations).empty());
  observations.repeated_in_image = 6;
  observations.degenerate = 1;
  const auto findings = observation_findings(observations);
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].cause, Cause::twin);
  EXPECT_EQ(findings[0].severity, Severity::warning);
  EXPECT_EQ(findings[0].subject, "6 detections");
  EXPECT_FALSE(findings[0].remedy.empty());
  EXPECT_EQ(findings[1].cause, Cause::wrong_id);
  EXPECT_EQ(findings[1].severity, Severity::note);
  EXPECT_EQ(findings[1].subject, "1 detection");
}

TEST(ObservationFindings, NameTheCameraWhoseCalibrationEnds) {
  const test::SyntheticRoom room = test::make_room({});
  Observations observations;
  observations.rigs.push_back(room.rig);
  for (std::size_t c = 0; c < room.rig.cameras.size(); ++c) {
    observations.cameras.push_back({RigIndex(0), c});
  }
  observations.beyond_calibration.assign(room.rig.cameras.size(), 0);
  EXPECT_FALSE(observations.any_seen());
  observations.beyond_calibration[CameraIndex(1)] = 12;
  EXPECT_TRUE(observations.any_seen());
  const auto findings = observation_findings(observations);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].severity, Severity::note);
  EXPECT_EQ(findings[0].subject, "cam1");
  EXPECT_NE(findings[0].text.find("12 detections left out"), std::string::npos);
}

}  // namespace
}  // namespace waymark
