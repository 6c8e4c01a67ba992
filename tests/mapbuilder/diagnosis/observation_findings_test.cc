#include "mapbuilder/diagnosis/observation_findings.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace waymark
