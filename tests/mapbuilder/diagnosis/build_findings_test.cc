#include "mapbuilder/diagnosis/build_findings.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark {
namespace {

using Told = std::vector<std::pair<Cause, std::string>>;

/// A sound build of two verified markers.
struct Sound {
  Sound() {
    BuiltSubMap submap;
    submap.converged = true;
    submap.covariances_known = true;
    submap.model_sigma_px = 0.2;
    for (const int number : {3, 7}) {
      MapMarker marker;
      marker.id = {Family::tag36h11, number};
      marker.verified = true;
      submap.map.markers.push_back(marker);
    }
    result.submaps.push_back(submap);
    observations.frame_sets.resize(10);
  }
  BuildResult result;
  Observations observations;

  /// Causes and how each text begins.
  [[nodiscard]] Told told() const {
    Told found;
    for (const Finding& finding : build_findings(result, observations)) {
      EXPECT_FALSE(finding.subject.empty());
      EXPECT_FALSE(finding.text.empty());
      EXPECT_TRUE(finding.severity == Severity::note || !finding.remedy.empty());
      found.emplace_back(finding.cause, finding.text.substr(0, 12));
    }
    return found;
  }
};

TEST(BuildFindings, NothingIsSaidOfASoundBuild) { EXPECT_EQ(Sound().told(), Told{}); }

TEST(BuildFindings, NothingIsSaidOfASoundRoom) {
  test::RoomOptions options;
  options.noise_px = 0.2;
  Observations observations = test::observations_of(test::make_room(options));
  Progress progress;
  const BuildResult result = build_map(Selection(observations), {}, progress);
  EXPECT_TRUE(build_findings(result, observations).empty());
}

TEST(BuildFindings, MarkersOfOneViewAreNamedAndNoOthers) {
  Sound build;
  build.result.submaps[0].map.markers[1].verified = false;
  const auto findings = build_findings(build.result, build.observations);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].cause, Cause::few_views);
  EXPECT_EQ(findings[0].subject, "marker 7");
  EXPECT_EQ(findings[0].markers, (std::vector<MarkerId>{{Family::tag36h11, 7}}));
  EXPECT_EQ(findings[0].submap, 0U);
}

TEST(BuildFindings, PartsAreCounted) {
  Sound build;
  build.result.submaps.push_back(build.result.submaps[0]);
  build.result.submaps[1].map.markers.pop_back();
  const auto findings = build_findings(build.result, build.observations);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].cause, Cause::disconnected);
  ASSERT_EQ(findings[0].figures.size(), 2U);
  EXPECT_EQ(findings[0].figures[1].value, 1.0);
}

TEST(BuildFindings, EachWeaknessOfASubMapHasItsFinding) {
  Sound unsettled;
  unsettled.result.submaps[0].converged = false;
  EXPECT_EQ(unsettled.told(), (Told{{Cause::map_misfit, "adjustment a"}}));
  Sound loose;
  loose.result.submaps[0].covariances_known = false;
  EXPECT_EQ(loose.told(), (Told{{Cause::few_views, "the uncertai"}}));
  Sound poor;
  poor.result.submaps[0].model_sigma_px = kLargestModelSigma;
  EXPECT_EQ(poor.told(), (Told{{Cause::map_misfit, "the map does"}}));
  poor.result.submaps[0].model_sigma_px = kLargestModelSigma * 0.99;
  EXPECT_EQ(poor.told(), Told{});
}

TEST(BuildFindings, WhatFoundNoPlaceIsSaid) {
  Sound build;
  build.result.unmapped = {{Family::tag36h11, 44}};
  build.result.unlocalized = {FrameSetIndex(1), FrameSetIndex(2)};
  build.result.without_markers = {FrameSetIndex(5)};
  build.observations.repeated_in_image = 6;
  build.observations.degenerate = 1;
  EXPECT_EQ(build.told(), (Told{{Cause::few_views, "seen but not"},
                                {Cause::few_views, "not localize"},
                                {Cause::twin, "left out: th"},
                                {Cause::wrong_id, "left out: th"},
                                {Cause::few_views, "without a us"}}));
  const auto findings = build_findings(build.result, build.observations);
  EXPECT_EQ(findings[0].subject, "marker 44");
  EXPECT_EQ(findings[1].subject, "2 frame sets");
  EXPECT_EQ(findings[3].severity, Severity::note);
  EXPECT_EQ(findings[4].severity, Severity::note);
}

}  // namespace
}  // namespace waymark
