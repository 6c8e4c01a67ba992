#include "mapbuilder/diagnosis/quarantine_findings.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

MarkerId id(int number) { return {Family::tag36h11, number}; }

/// A map of markers 1 … 5.
BuildResult mapped() {
  BuildResult result;
  SubMap& map = result.map.submaps.emplace_back();
  for (int number = 1; number <= 5; ++number) map.markers.emplace_back().id = id(number);
  return result;
}

const Quarantine kQuarantine{"0123456789abcdef",
                             {{id(1), QuarantineState::moved, 7, 0.25},
                              {id(2), QuarantineState::moved, 7, 0.1},
                              {id(3), QuarantineState::moved, 7, 0.1},
                              {id(4), QuarantineState::unknown, 7, 0},
                              {id(8), QuarantineState::moved, 7, 0.1},
                              {id(9), QuarantineState::unknown, 7, 0}}};

const Finding* of(const std::vector<Finding>& findings, const char* text,
                  const std::vector<MarkerId>& markers) {
  for (const Finding& finding : findings) {
    if (finding.cause == Cause::moved && finding.markers == markers &&
        finding.text.find(text) != std::string::npos) {
      return &finding;
    }
  }
  return nullptr;
}

TEST(QuarantineFindings, ConfirmRefuteAndNameWhatNothingTells) {
  FrameComparison comparison;
  comparison.moved = {{id(1), 0.26, 0.01, {}, {}}};
  comparison.suspects_in_place = {{id(2), 0.001, 0.001, {}, {}}};
  const auto findings = quarantine_findings(kQuarantine, mapped(), &comparison, false);
  EXPECT_EQ(findings.size(), 5U);
  const Finding* confirmed = of(findings, "the vehicle was right", {id(1)});
  ASSERT_NE(confirmed, nullptr);
  EXPECT_EQ(confirmed->figures[0].value, 0.26);
  EXPECT_EQ(confirmed->figures[1].value, 0.25);
  EXPECT_NE(of(findings, "stands where it stood", {id(2)}), nullptr);
  EXPECT_NE(of(findings, "mapped now", {id(4)}), nullptr);
  EXPECT_NE(of(findings, "not mapped now", {id(8), id(9)}), nullptr);
  EXPECT_NE(of(findings, "not compared", {id(3)}), nullptr);
}

TEST(QuarantineFindings, WithoutTheEarlierMapNothingIsConfirmedOrRefuted) {
  const auto findings = quarantine_findings(kQuarantine, mapped(), nullptr, false);
  const Finding* open = of(findings, "not compared", {id(1), id(2), id(3)});
  ASSERT_NE(open, nullptr);
  EXPECT_NE(open->text.find("0123456789abcdef"), std::string::npos);
  EXPECT_NE(open->remedy.find("--frame-of"), std::string::npos);
}

TEST(QuarantineFindings, OnlyMovedOnesAreKeptFromCarryingAFrame) {
  EXPECT_EQ(moved_markers(kQuarantine), (std::set<MarkerId>{id(1), id(2), id(3), id(8)}));
}

}  // namespace
}  // namespace waymark
