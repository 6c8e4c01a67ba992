#include "mapbuilder/diagnosis/survey_sides.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "core/marker/marker_geometry.h"
#include "tests/mapbuilder/diagnosis/measured_room.h"

namespace waymark {
namespace {

using test::MeasuredRoom;

constexpr double kSigma_m = 0.003;
constexpr std::uint32_t kVariants = 24;

Survey points_of(MeasuredRoom& room, std::size_t count) {
  Survey survey;
  for (const int number : room.some_markers(count)) {
    survey.points.push_back({{{Family::tag36h11, number}, std::nullopt},
                             room.measured(number, kSigma_m),
                             kSigma_m,
                             SurveyUse::fit});
  }
  return survey;
}

Survey distances_of(MeasuredRoom& room, std::size_t count) {
  Survey survey;
  const std::vector<int> numbers = room.some_markers(2 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const double apart_m =
        (room.measured(numbers[i], 0) - room.measured(numbers[i + count], kSigma_m)).norm();
    survey.distances.push_back({{{Family::tag36h11, numbers[i]}, std::nullopt},
                                {{Family::tag36h11, numbers[i + count]}, std::nullopt},
                                apart_m,
                                kSigma_m,
                                SurveyUse::fit});
  }
  return survey;
}

JudgedSurvey judged(const MeasuredRoom& room, const Survey& survey,
                    std::optional<bool> baselines = std::nullopt) {
  return judge_survey(survey, room.result, room.observations, [&](double) { return baselines; });
}

/// How often exactly one finding, of this cause, comes of the variants; whether it is right beside
/// that.
class Tally {
 public:
  void count(const JudgedSurvey& judged, Cause cause, bool right_beside = true) {
    ++all_;
    const bool right =
        judged.findings.size() == 1 && judged.findings[0].cause == cause && right_beside;
    right_ += right ? 1 : 0;
    if (right) return;
    for (const Finding& finding : judged.findings) missed_ += one_line(finding) + "\n";
    if (judged.findings.empty()) missed_ += "nothing\n";
  }
  /// 95 % of the variants.
  void expect_right() const { EXPECT_GE(20 * right_, 19 * all_) << missed_; }

 private:
  int all_ = 0;
  int right_ = 0;
  std::string missed_;
};

std::size_t in_use(const Survey& survey) {
  return static_cast<std::size_t>(
      std::count_if(survey.points.begin(), survey.points.end(),
                    [](const SurveyedPoint& point) { return point.use == SurveyUse::fit; }));
}

TEST(SurveySides, SoundSurveysAreTakenWithoutAWord) {
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    MeasuredRoom room(seed);
    Survey survey = points_of(room, 3 + seed % 8);
    survey.distances = distances_of(room, seed % 5).distances;
    const JudgedSurvey sound = judged(room, survey);
    EXPECT_THAT(sound.findings, testing::IsEmpty())
        << seed << ": " << one_line(sound.findings.front());
    EXPECT_EQ(in_use(sound.survey), survey.points.size());
    EXPECT_FALSE(sound.sizes_times);
    EXPECT_TRUE(sound.z_is_up);
  }
}

TEST(SurveySides, OneTypingErrorIsNamedAloneAndLeftOut) {
  Tally tally;
  for (std::uint32_t seed = 1; seed <= kVariants; ++seed) {
    MeasuredRoom room(seed);
    Survey survey = points_of(room, 4 + seed % 6);
    SurveyedPoint& wrong = survey.points[seed % survey.points.size()];
    wrong.position_m[seed % 3] += (seed % 2 == 0 ? 1 : -1) * room.uniform(0.05, 2.0);
    const JudgedSurvey result = judged(room, survey);
    tally.count(result, Cause::survey_entry,
                in_use(result.survey) == survey.points.size() - 1 &&
                    result.findings[0].markers == std::vector{wrong.place.marker});
  }
  tally.expect_right();
}

TEST(SurveySides, TwoExchangedIdsAreNamedTogether) {
  Tally tally;
  for (std::uint32_t seed = 1; seed <= kVariants; ++seed) {
    MeasuredRoom room(seed);
    Survey survey = points_of(room, 6 + seed % 5);
    std::swap(survey.points[0].position_m, survey.points[1 + seed % 4].position_m);
    const JudgedSurvey result = judged(room, survey);
    tally.count(result, Cause::survey_entry,
                in_use(result.survey) == survey.points.size() - 2 &&
                    result.findings[0].text.starts_with("exchanged"));
  }
  tally.expect_right();
}

TEST(SurveySides, ALeftHandedSurveyIsToldWhicheverAxis) {
  Tally tally;
  for (std::uint32_t seed = 1; seed <= kVariants; ++seed) {
    MeasuredRoom room(seed);
    Survey survey = points_of(room, 6 + seed % 5);
    for (SurveyedPoint& point : survey.points) {
      Eigen::Vector3d& x = point.position_m;
      if (seed % 3 == 0) x.y() = 5 - x.y();
      if (seed % 3 == 1) std::swap(x.y(), x.z());
      if (seed % 3 == 2) x.x() = -x.x();
    }
    const JudgedSurvey result = judged(room, survey);
    tally.count(result, Cause::survey_mirrored, in_use(result.survey) == 0);
  }
  tally.expect_right();
}

TEST(SurveySides, AFlatPlanWhoseYPointsDownWouldHangTheCamerasUpsideDown) {
  Tally tally;
  for (std::uint32_t seed = 1; seed <= kVariants; ++seed) {
    MeasuredRoom room(seed);
    Survey survey = points_of(room, 4 + seed % 6);
    for (SurveyedPoint& point : survey.points) {
      const double z =
          room.room.world_from_marker[static_cast<std::size_t>(point.place.marker.number)]
              .translation.z();
      // All at one height: their own spots on lines of one height.
      point.position_m.y() = 7 - point.position_m.y();
      point.position_m.z() += 1.7 - z;
      for (MapMarker& marker : room.result.submaps[0].map.markers) {
        if (marker.id != point.place.marker) continue;
        const Rigid3 world_from_room = room.result.submaps[0].trajectory[0].world_from_rig *
                                       room.room.world_from_rig[0].inverse();
        marker.world_from_marker.translation +=
            world_from_room.rotation * Eigen::Vector3d(0, 0, 1.7 - z);
      }
    }
    tally.count(judged(room, survey), Cause::survey_mirrored);
  }
  tally.expect_right();
}

TEST(SurveySides, PointsMeasuredAtAnotherCornerAreTakenThere) {
  Tally tally;
  for (std::uint32_t seed = 1; seed <= kVariants; ++seed) {
    MeasuredRoom room(seed);
    Survey survey = points_of(room, 6 + seed % 6);
    const int corner = static_cast<int>(seed % 4);
    for (SurveyedPoint& point : survey.points) {
      point.position_m = room.measured(point.place.marker.number, kSigma_m,
                                       marker_corners(0.3)[static_cast<std::size_t>(corner)]);
    }
    const JudgedSurvey result = judged(room, survey);
    tally.count(result, Cause::survey_corner, result.survey.points[0].place.corner == corner);
  }
  tally.expect_right();
}

TEST(SurveySides, ASurveyInAnotherUnitIsNamedWithIt) {
  Tally tally;
  for (std::uint32_t seed = 1; seed <= kVariants; ++seed) {
    MeasuredRoom room(seed);
    const bool points = seed % 2 == 0;
    Survey survey = points ? points_of(room, 4 + seed % 5) : distances_of(room, 2 + seed % 3);
    const double per_metre = std::array{1000.0, 100.0, 39.3701, 3.28084}[seed / 2 % 4];
    for (SurveyedPoint& point : survey.points) point.position_m *= per_metre;
    for (SurveyedDistance& distance : survey.distances) distance.distance_m *= per_metre;
    const JudgedSurvey result = judged(room, survey, false);
    const bool taken = std::any_of(result.survey.distances.begin(), result.survey.distances.end(),
                                   [](const auto& d) { return d.use == SurveyUse::fit; });
    tally.count(result, Cause::survey_unit, in_use(result.survey) == 0 && !taken);
  }
  tally.expect_right();
}

TEST(SurveySides, SizesThatStandAloneAreNamedWithTheFactor) {
  Tally tally;
  for (std::uint32_t seed = 1; seed <= kVariants; ++seed) {
    MeasuredRoom room(seed);
    const double factor = std::array{0.8, 1.25, 0.9, 1.15}[seed % 4];
    Survey survey = seed % 2 == 0 ? points_of(room, 5) : distances_of(room, 2 + seed % 3);
    for (SurveyedPoint& point : survey.points) point.position_m /= factor;
    for (SurveyedDistance& distance : survey.distances) distance.distance_m /= factor;
    const std::optional<bool> baselines = seed % 3 == 0 ? std::optional(true) : std::nullopt;
    const JudgedSurvey result = judged(room, survey, baselines);
    tally.count(result, Cause::size_scale,
                result.sizes_times && std::abs(*result.sizes_times * factor - 1) < 0.01);
  }
  tally.expect_right();
}

TEST(SurveySides, TwoAgainstTwoIsSaidWithBothRemediesAndNothingIsTaken) {
  Tally tally;
  for (std::uint32_t seed = 1; seed <= kVariants; ++seed) {
    MeasuredRoom room(seed);
    Survey survey = seed % 2 == 0 ? points_of(room, 5) : distances_of(room, 2);
    const double factor = room.uniform(1.12, 1.3);
    for (SurveyedPoint& point : survey.points) point.position_m *= factor;
    for (SurveyedDistance& distance : survey.distances) distance.distance_m *= factor;
    const JudgedSurvey result = judged(room, survey, false);
    tally.count(result, Cause::size_scale,
                !result.sizes_times && in_use(result.survey) == 0 &&
                    result.findings[0].remedy.find("survey's lengths") != std::string::npos);
  }
  tally.expect_right();
}

TEST(SurveySides, OneDistanceOfThreeThatStandsAloneIsLeftOut) {
  Tally tally;
  for (std::uint32_t seed = 1; seed <= kVariants; ++seed) {
    MeasuredRoom room(seed);
    Survey survey = distances_of(room, 3);
    survey.distances[seed % 3].distance_m *= seed % 2 == 0 ? 1.3 : 0.7;
    const JudgedSurvey result = judged(room, survey);
    tally.count(result, Cause::survey_entry,
                result.survey.distances[seed % 3].use == SurveyUse::left_out);
  }
  tally.expect_right();
}

TEST(SurveySides, OnePartOfAMapLeavesTheOthersPointsInUse) {
  MeasuredRoom room(3);
  BuiltSubMap& first = room.result.submaps[0];
  BuiltSubMap second = first;
  first.map.markers.resize(15);
  second.map.markers.erase(second.map.markers.begin(), second.map.markers.begin() + 15);
  room.result.submaps.push_back(second);
  Survey survey = points_of(room, 30);
  std::size_t in_mm = 0;
  for (SurveyedPoint& point : survey.points) {
    if (point.place.marker.number >= 15) continue;
    point.position_m *= 1000;
    ++in_mm;
  }
  ASSERT_EQ(in_mm, 15U);
  const JudgedSurvey result = judged(room, survey);
  ASSERT_EQ(result.findings.size(), 1U);
  EXPECT_EQ(result.findings[0].cause, Cause::survey_unit);
  EXPECT_EQ(in_use(result.survey), 15U);
}

TEST(SurveySides, AxesThatAreTurnedLeaveZUnknown) {
  MeasuredRoom room(3);
  Survey survey = points_of(room, 8);
  for (SurveyedPoint& point : survey.points) {
    const Eigen::Vector3d x = point.position_m;
    point.position_m = {x.x(), x.z(), -x.y()};
  }
  const JudgedSurvey result = judged(room, survey);
  ASSERT_EQ(result.findings.size(), 1U);
  EXPECT_EQ(result.findings[0].cause, Cause::not_level);
  EXPECT_THAT(result.findings[0].text, testing::HasSubstr("+y"));
  EXPECT_FALSE(result.z_is_up);
  EXPECT_EQ(in_use(result.survey), 8U);
}

}  // namespace
}  // namespace waymark
