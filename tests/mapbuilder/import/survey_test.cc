#include "mapbuilder/import/survey.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

Expected<Survey> parsed(std::string_view text) {
  return parse_survey(text, "survey.toml", Family::tag36h11);
}

TEST(Survey, ReadsPointsAndDistances) {
  const auto survey = parsed(R"(
[[points]]
id = 12
position_m = [12.4, 3.05, 1.5]
sigma_m = 0.002
use = "check"
[[distances]]
from = { id = 24, corner = "bottom-left" }
to = { id = "tag36h11:60", corner = "top-right" }
distance_m = 6.017
sigma_m = 0.0016
)");
  ASSERT_TRUE(survey) << survey.error().message;
  ASSERT_EQ(survey->points.size(), 1U);
  EXPECT_EQ(survey->points[0].use, SurveyUse::check);
  EXPECT_FALSE(survey->points[0].place.corner) << "the centre is the default";
  EXPECT_EQ(survey->points[0].position_m, Eigen::Vector3d(12.4, 3.05, 1.5));
  ASSERT_EQ(survey->distances.size(), 1U);
  EXPECT_EQ(survey->distances[0].use, SurveyUse::fit);
  EXPECT_EQ(survey->distances[0].from.corner, 3);
  EXPECT_EQ(survey->distances[0].to.corner, 1);
  EXPECT_EQ(survey->distances[0].to.marker, (MarkerId{Family::tag36h11, 60}));
  EXPECT_EQ(format_place(survey->distances[0].from, false), "24 bottom-left");
}

struct BadSurvey {
  const char* name;
  const char* text;
  const char* says;
};

class BadSurveys : public testing::TestWithParam<BadSurvey> {};

TEST_P(BadSurveys, AreRefusedNamingTheLine) {
  const auto survey = parsed(GetParam().text);
  ASSERT_FALSE(survey);
  EXPECT_EQ(survey.error().kind, ErrorKind::bad_data);
  EXPECT_NE(survey.error().message.find(GetParam().says), std::string::npos)
      << survey.error().message;
  EXPECT_NE(survey.error().message.find("survey.toml"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(
    Each, BadSurveys,
    testing::Values(
        BadSurvey{"misspelt_key", "[[point]]\nid = 1\n", "point"},
        BadSurvey{"unknown_corner",
                  "[[points]]\nid = 1\ncorner = \"left\"\nposition_m = [0, 0, 0]\nsigma_m = 0.01\n",
                  "corner"},
        BadSurvey{"no_id", "[[points]]\nposition_m = [0, 0, 0]\nsigma_m = 0.01\n", "id"},
        BadSurvey{"id_outside_family",
                  "[[points]]\nid = 100000\nposition_m = [0, 0, 0]\nsigma_m = 0.01\n", "100000"},
        BadSurvey{"two_coordinates", "[[points]]\nid = 1\nposition_m = [0, 0]\nsigma_m = 0.01\n",
                  "position_m"},
        BadSurvey{"sigma_of_zero", "[[points]]\nid = 1\nposition_m = [0, 0, 0]\nsigma_m = 0.0\n",
                  "sigma_m"},
        BadSurvey{"negative_distance",
                  "[[distances]]\nfrom = { id = 1 }\nto = { id = 2 }\ndistance_m = -1\nsigma_m = "
                  "0.01\n",
                  "distance_m"},
        BadSurvey{"nan_distance",
                  "[[distances]]\nfrom = { id = 1 }\nto = { id = 2 }\ndistance_m = nan\nsigma_m = "
                  "0.01\n",
                  "distance_m"},
        BadSurvey{"one_end_only",
                  "[[distances]]\nfrom = { id = 1 }\ndistance_m = 1\nsigma_m = 0.01\n", "to"},
        BadSurvey{"same_place",
                  "[[distances]]\nfrom = { id = 1 }\nto = { id = 1 }\ndistance_m = 1\nsigma_m = "
                  "0.01\n",
                  "same place"},
        BadSurvey{"unknown_use",
                  "[[points]]\nid = 1\nposition_m = [0, 0, 0]\nsigma_m = 0.01\nuse = \"maybe\"\n",
                  "use"},
        BadSurvey{"no_toml", "[[points\n", "survey.toml"}),
    [](const auto& info) { return info.param.name; });

TEST(Survey, ABareNumberNeedsOneFamily) {
  const auto survey = parse_survey("[[points]]\nid = 1\nposition_m = [0, 0, 0]\nsigma_m = 0.01\n",
                                   "survey.toml", std::nullopt);
  EXPECT_FALSE(survey);
}

}  // namespace
}  // namespace waymark
