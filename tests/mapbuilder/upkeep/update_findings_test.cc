#include "mapbuilder/upkeep/update_findings.h"

#include <gmock/gmock.h>

namespace waymark {
namespace {

using testing::HasSubstr;

MarkerId id(int number) { return {Family::tag36h11, number}; }

ComparedMarker off(int number, double distance_m) {
  ComparedMarker marker;
  marker.id = id(number);
  marker.distance_m = distance_m;
  marker.sigma_m = 0.001;
  return marker;
}

MapUpdate some_update() {
  MapUpdate update;
  UpdatedPart part;
  part.comparison.moved = {off(1, 0.3), off(2, 0.2)};
  part.comparison.appeared = {id(30), id(31)};
  part.comparison.vanished = {id(5), id(6)};
  part.comparison.stayed.resize(7);
  part.comparison.suspects_in_place = {off(8, 0.001)};
  update.parts = {part};
  update.moved = {off(1, 0.3)};
  update.doubted = {off(2, 0.2)};
  update.appeared = {id(30)};
  update.missing = {{id(5), 9}};
  update.unseen = {id(6)};
  update.shifted = {off(9, 0.008)};
  return update;
}

const Finding* about(const std::vector<Finding>& findings, int number) {
  for (const Finding& finding : findings) {
    if (finding.markers == std::vector{id(number)}) return &finding;
  }
  return nullptr;
}

TEST(UpdateFindings, NameWhatHasChangedAndNobodyElse) {
  const auto findings = update_findings(some_update(), {}, false);
  EXPECT_EQ(findings.size(), 5U);
  ASSERT_NE(about(findings, 1), nullptr);
  EXPECT_EQ(about(findings, 1)->cause, Cause::moved);
  EXPECT_THAT(about(findings, 1)->text, HasSubstr("300.0 mm"));
  EXPECT_EQ(about(findings, 2)->cause, Cause::few_views);
  EXPECT_THAT(about(findings, 2)->text, HasSubstr("it is left there"));
  EXPECT_EQ(about(findings, 30)->severity, Severity::note);
  EXPECT_EQ(about(findings, 31), nullptr);
  EXPECT_EQ(about(findings, 6), nullptr);
  EXPECT_THAT(about(findings, 9)->text, HasSubstr("8.0 sigmas"));
}

TEST(UpdateFindings, SayWhatBecameOfWhoIsMissing) {
  const auto kept = update_findings(some_update(), {}, false);
  EXPECT_THAT(about(kept, 5)->text, HasSubstr("not seen where it should be: 9 frame sets"));
  EXPECT_THAT(about(kept, 5)->text, HasSubstr("it is kept, as not verified"));
  EXPECT_EQ(about(kept, 5)->severity, Severity::warning);
  const auto dropped = update_findings(some_update(), {{}, true, {}}, false);
  EXPECT_THAT(about(dropped, 5)->text, HasSubstr("it has left the map"));
}

TEST(UpdateFindings, SayWhereSigmasDoNotHoldBeyondTwice) {
  for (const double misfit : {1.9, 2.1}) {
    MapUpdate update;
    update.parts.resize(1);
    update.parts[0].misfit_sigmas = misfit;
    const auto findings = update_findings(update, {}, false);
    EXPECT_EQ(findings.size(), misfit > 2 ? 1U : 0U);
    for (const Finding& finding : findings) EXPECT_EQ(finding.cause, Cause::map_misfit);
  }
}

TEST(UpdateFindings, PartsThatStayApart) {
  MapUpdate update;
  update.joined_parts = {0};
  update.not_taken = {id(3)};
  update.other_part = {id(4)};
  const auto findings = update_findings(update, {}, false);
  EXPECT_EQ(findings.size(), 3U);
  EXPECT_EQ(about(findings, 3)->cause, Cause::disconnected);
  EXPECT_EQ(about(findings, 4)->cause, Cause::moved);
}

TEST(UpdateFindings, TheWholeComparisonIsThatOfAllPartsWithoutDoubts) {
  const FrameComparison whole = whole_comparison(some_update());
  ASSERT_EQ(whole.moved.size(), 1U);
  EXPECT_EQ(whole.moved[0].id, id(1));
  ASSERT_EQ(whole.suspects_in_place.size(), 1U);
  EXPECT_EQ(whole.suspects_in_place[0].id, id(8));
}

}  // namespace
}  // namespace waymark
