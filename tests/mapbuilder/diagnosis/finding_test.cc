#include "mapbuilder/diagnosis/finding.h"

#include <gtest/gtest.h>

#include <set>

namespace waymark {
namespace {

TEST(Finding, EveryKindHasANameOfItsOwn) {
  std::set<std::string_view> names;
  const int kinds = static_cast<int>(FindingKind::no_square) + 1;
  for (int i = 0; i < kinds; ++i) names.insert(name_of(static_cast<FindingKind>(i)));
  EXPECT_EQ(names.size(), static_cast<std::size_t>(kinds));
  EXPECT_FALSE(names.contains(""));
  EXPECT_EQ(name_of(FindingKind::wrong_size), "wrong_size");
  EXPECT_EQ(name_of(FindingKind::marker_vanished), "marker_vanished");
  EXPECT_EQ(name_of(Severity::note), "note");
}

TEST(Finding, OneLineHoldsAllThatATerminalNeeds) {
  Finding finding;
  finding.title = "2 markers rest on one view";
  finding.evidence = "Nothing confirms them.";
  finding.remedy = "Record another view.";
  finding.markers = {{Family::tag36h11, 3}, {Family::tag36h11, 12}};
  EXPECT_EQ(one_line(finding, false),
            "warning: 2 markers rest on one view: Nothing confirms them. Record another view. "
            "Markers: 3, 12");
  EXPECT_NE(one_line(finding, true).find("tag36h11:3, tag36h11:12"), std::string::npos);
}

TEST(Finding, LongListsAreCut) {
  Finding finding;
  finding.title = "Many";
  finding.evidence = "Seen.";
  for (int i = 0; i < 30; ++i) finding.markers.push_back({Family::tag36h11, i});
  EXPECT_EQ(one_line(finding, false).find("in all"), std::string::npos);
  finding.markers.push_back({Family::tag36h11, 30});
  const std::string line = one_line(finding, false);
  EXPECT_EQ(line.substr(line.size() - std::string("29, … (31 in all)").size()),
            "29, … (31 in all)");
}

}  // namespace
}  // namespace waymark
