#include "mapbuilder/diagnosis/rig_correction.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

RigExplanation inverted_chain() {
  RigExplanation explanation;
  explanation.cause = Cause::rig_inverted;
  explanation.cameras = {1, 2};
  explanation.detail = "T_cn_cnm1 is written the other way round";
  explanation.remedy = "Invert it.";
  return explanation;
}

TEST(RigCorrection, ACauseAloneIsToldWithItsRemedy) {
  const Finding finding = finding_of(inverted_chain(), test::ring_rig(3));
  EXPECT_EQ(finding.severity, Severity::error);
  EXPECT_EQ(finding.subject, "cam1, cam2");
  EXPECT_EQ(finding.text, "T_cn_cnm1 is written the other way round.");
  EXPECT_EQ(finding.remedy, "Invert it.");
}

// Both remedies together would leave the rig as wrong as before.
TEST(RigCorrection, TwoThatLookAlikeAreOneFindingWithOneRemedyOfTwo) {
  RigExplanation explanation = inverted_chain();
  explanation.alternative = {Cause::rig_exchanged, {0, 2}, "each stands at the other's", "Swap."};
  const Finding finding = finding_of(explanation, test::ring_rig(3));
  EXPECT_EQ(finding.cause, Cause::rig_inverted);
  EXPECT_EQ(finding.subject, "cam1, cam2");
  EXPECT_THAT(finding.text, HasSubstr("[rig_exchanged] cam0, cam2: each stands at the other's."));
  EXPECT_EQ(finding.remedy, "Do one of the two. Either: Invert it. Or: Swap.");
  EXPECT_THAT(finding.cameras, ElementsAre("cam0", "cam1", "cam2"));
}

}  // namespace
}  // namespace waymark
