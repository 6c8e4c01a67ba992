#include "mapbuilder/diagnosis/finding.h"

#include <gmock/gmock.h>

namespace waymark {
namespace {

using testing::EndsWith;

MarkerId id(int number) { return {Family::tag36h11, number}; }

TEST(Finding, TheLineIsThatOfTheFormats) {
  Finding finding;
  finding.severity = Severity::error;
  finding.cause = Cause::rig_inverted;
  finding.subject = "cam1, cam2";
  finding.text = "T_cn_cnm1 is written the other way round.";
  EXPECT_EQ(one_line(finding),
            "error [rig_inverted] cam1, cam2: T_cn_cnm1 is written the other way round.");
  finding.severity = Severity::note;
  finding.remedy = "Invert it.";
  EXPECT_EQ(one_line(finding).rfind("note [rig_inverted] ", 0), 0U);
  EXPECT_THAT(one_line(finding), EndsWith("round. Invert it."));
}

TEST(Finding, WhatItQuotesNeverBreaksTheLine) {
  Finding finding;
  finding.subject = "a capture\n\x1b[31m";
  finding.text = "x.";
  EXPECT_EQ(one_line(finding).find_first_of("\n\x1b"), std::string::npos);
}

TEST(Finding, SubjectsNameMarkersUpToThirty) {
  EXPECT_EQ(subject_of({id(3)}, false), "marker 3");
  EXPECT_EQ(subject_of({id(3), id(12)}, false), "markers 3, 12");
  EXPECT_EQ(subject_of({id(3)}, true), "marker tag36h11:3");
  std::vector<MarkerId> many;
  for (int i = 0; i < 30; ++i) many.push_back(id(i));
  EXPECT_THAT(subject_of(many, false), EndsWith("28, 29"));
  many.push_back(id(30));
  EXPECT_THAT(subject_of(many, false), EndsWith("29, … (31 in all)"));
}

TEST(Finding, NoStandardDeviationIsRoundedToNothing) {
  EXPECT_EQ(give_or_take(34.63, 0.61, " mm", 1), "34.6 ± 0.6 mm");
  EXPECT_EQ(give_or_take(0.0612, 0.004, "°", 2), "0.061 ± 0.004°");
  EXPECT_EQ(give_or_take(-0.031, 0.012, " %", 2), "-0.03 ± 0.01 %");
  EXPECT_EQ(give_or_take(1, 0, "", 1), "1.0 ± 0.0");
}

}  // namespace
}  // namespace waymark
