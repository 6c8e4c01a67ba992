#include "mapbuilder/diagnosis/survey_points.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/marker/marker_geometry.h"
#include "tests/mapbuilder/diagnosis/measured_room.h"

namespace waymark {
namespace {

using test::MeasuredRoom;

MarkerPlace place_on(int number, std::optional<int> corner = std::nullopt) {
  return {{Family::tag36h11, number}, corner};
}

/// Centres of markers 0, 1, 2, …, each measured to 3 mm.
JudgedSurvey with_points(MeasuredRoom& room, std::size_t count) {
  constexpr double kSigma_m = 0.003;
  JudgedSurvey judged;
  for (int number = 0; number < static_cast<int>(count); ++number) {
    judged.survey.points.push_back(
        {place_on(number), room.measured(number, kSigma_m), kSigma_m, SurveyUse::fit});
  }
  return judged;
}

SurveyPointsOfMap judge(const MeasuredRoom& room, JudgedSurvey& judged) {
  return judge_survey_points(room.result.submaps[0], room.result, room.observations, judged);
}

TEST(SurveyPoints, ASpotIsTheCentreOrACornerWhereTheImagesHaveTheMarker) {
  MeasuredRoom room(1);
  SubMap& map = room.result.submaps[0].map;
  const MapMarker& marker = map.markers[3];
  const auto centre = spot_on(map, place_on(3));
  ASSERT_TRUE(centre);
  EXPECT_EQ(centre->x_in_world(), marker.world_from_marker.translation);
  EXPECT_NEAR(centre->sigma_m, MeasuredRoom::kMap_m, 1e-12);
  const auto corner = spot_on(map, place_on(3, 2));
  ASSERT_TRUE(corner);
  EXPECT_EQ(corner->x_in_world(), marker.world_from_marker * marker_corners(marker.size_m)[2]);
  EXPECT_FALSE(spot_on(map, place_on(999)));
}

TEST(SurveyPoints, AnUnknownCovarianceIsWorthACentimetre) {
  MeasuredRoom room(1);
  SubMap& map = room.result.submaps[0].map;
  map.markers[3].covariance.setConstant(std::nan(""));
  ASSERT_FALSE(map.markers[3].covariance_known());
  EXPECT_EQ(spot_on(map, place_on(3))->sigma_m, 0.01);
}

TEST(SurveyPoints, WhatAgreesWithTheMapStatesItsScale) {
  MeasuredRoom room(2);
  JudgedSurvey judged = with_points(room, 8);
  const SurveyPointsOfMap points = judge(room, judged);
  EXPECT_EQ(points.entries.size(), 8U);
  ASSERT_TRUE(points.scale);
  EXPECT_NEAR(points.scale->log_scale, 0, 4 * points.scale->sigma);
  EXPECT_EQ(points.scale->weight, 2.0);
  EXPECT_TRUE(judged.findings.empty());
}

TEST(SurveyPoints, ThreePointsHaveOneVoteAndTwoSayNothing) {
  MeasuredRoom room(2);
  JudgedSurvey three = with_points(room, 3);
  const SurveyPointsOfMap points = judge(room, three);
  ASSERT_TRUE(points.scale);
  EXPECT_EQ(points.scale->weight, 1.0);
  JudgedSurvey two = with_points(room, 2);
  EXPECT_FALSE(judge(room, two).scale);
  EXPECT_TRUE(two.findings.empty());
}

TEST(SurveyPoints, PointsOfAnotherPartOfTheMapAreNotAskedNorTouched) {
  MeasuredRoom room(2);
  JudgedSurvey judged = with_points(room, 8);
  room.result.submaps[0].map.markers.resize(4);
  const SurveyPointsOfMap points = judge(room, judged);
  EXPECT_EQ(points.entries, (std::vector<std::size_t>{0, 1, 2, 3}));
}

}  // namespace
}  // namespace waymark
