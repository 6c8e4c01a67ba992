#include "mapbuilder/report/summary_json.h"

#include <gtest/gtest.h>

#include "core/base/atomic_file.h"
#include "tests/mapbuilder/report/small_report.h"

namespace waymark {
namespace {

TEST(Summary, IsAsTheGoldenFileHasIt) {
  const auto golden = read_file(WAYMARK_GOLDEN_SUMMARY);
  ASSERT_TRUE(golden) << golden.error().message;
  EXPECT_EQ(format_summary(test::small_report()), *golden)
      << "a change of summary.json's form: raise kSummarySchema where a key changed its meaning";
}

TEST(Summary, ReadsBack) {
  const auto json = nlohmann::json::parse(format_summary(test::small_report()));
  EXPECT_EQ(json.at("schema"), kSummarySchema);
  EXPECT_EQ(json.at("map"), "</script><img src=x onerror=alert(1)>.map");
  EXPECT_EQ(json.at("submaps").at(0).at("markers").at(1).at("id"), 12);
  EXPECT_EQ(json.at("findings").at(0).at("cause"), "size");
}

TEST(Summary, UnknownCovariancesAreNullNotZero) {
  auto report = test::small_report();
  report.submaps[0].covariances_known = false;
  const auto marker = summary_json(report).at("submaps").at(0).at("markers").at(0);
  EXPECT_TRUE(marker.at("sigma_position_m").is_null());
  EXPECT_TRUE(marker.at("sigma_rotation_deg").is_null());
  EXPECT_TRUE(marker.at("sigma_metric_position_m").is_null());
}

TEST(Summary, IdsNameTheirFamilyWhereSeveralMeet) {
  auto report = test::small_report();
  report.unmapped.push_back({Family::aruco_4x4_50, 7});
  const auto json = summary_json(report);
  EXPECT_EQ(json.at("submaps").at(0).at("markers").at(0).at("id"), "tag36h11:3");
  EXPECT_EQ(json.at("unmapped").at(1), "aruco_4x4_50:7");
  EXPECT_EQ(json.at("findings").at(0).at("markers").at(0), "tag36h11:12");
}

}  // namespace
}  // namespace waymark
