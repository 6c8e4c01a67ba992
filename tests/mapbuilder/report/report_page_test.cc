#include "mapbuilder/report/report_page.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "mapbuilder/report/page_template.h"
#include "mapbuilder/report/summary_json.h"
#include "tests/mapbuilder/report/small_report.h"

namespace waymark {
namespace {

std::string joined(std::span<const std::string_view> pieces) {
  std::string text;
  for (const std::string_view piece : pieces) text += piece;
  return text;
}

/// What stands in the data block.
std::string data_of(const std::string& page) {
  const std::size_t before = joined(page_before_data()).size();
  return page.substr(before, page.size() - before - joined(page_after_data()).size());
}

TEST(ReportPage, BearsItsMark) {
  EXPECT_EQ(format_report_page(test::small_report()).rfind(kPageMark, 0), 0U);
}

TEST(ReportPage, HostileNamesStayData) {
  const std::string page = format_report_page(test::small_report());
  const std::string data = data_of(page);
  EXPECT_EQ(data.find('<'), std::string::npos);
  const auto json = nlohmann::json::parse(data);
  EXPECT_EQ(json.at("summary").at("map"), "</script><img src=x onerror=alert(1)>.map");
  EXPECT_EQ(json.at("summary").at("captures").at(1).at("name"), "not UTF-8: \uFFFD\uFFFD");
}

TEST(ReportPage, HoldsTheSummaryAsTheFileHasIt) {
  const auto report = test::small_report();
  const auto json = nlohmann::json::parse(data_of(format_report_page(report)));
  EXPECT_EQ(json.at("summary"), nlohmann::json::parse(format_summary(report)));
  const auto& scene = json.at("scene");
  ASSERT_EQ(scene.size(), report.submaps.size());
  EXPECT_EQ(scene.at(0).at("position_covariances_m2").size(), 3U);
  EXPECT_TRUE(scene.at(1).at("position_covariances_m2").empty());
  EXPECT_EQ(scene.at(0).at("tracks").at(0).at("poses").at(1), (nlohmann::json{1, 1, 1, 0}));
}

TEST(ReportPage, AsksForNothingFromAnywhere) {
  const std::string page = joined(page_before_data()) + joined(page_after_data());
  EXPECT_NE(page.find("default-src 'none'; script-src 'sha256-"), std::string::npos);
  EXPECT_EQ(page.find("unsafe-inline"), std::string::npos);
  EXPECT_FALSE(std::regex_search(
      page, std::regex(R"(<(script|link|img|iframe)[^>]*(src|href)="(?!data:))")));
}

TEST(ReportPage, LongTracksAreThinnedToWhatAScreenShows) {
  auto report = test::small_report();
  auto& poses = report.submaps[0].tracks[0].poses;
  poses.clear();
  for (int i = 0; i < 90'001; ++i) {
    poses.push_back({Stamp{i * 1'000'000L}, {Eigen::Quaterniond::Identity(), {0.001 * i, 0, 0}}});
  }
  const auto json = nlohmann::json::parse(data_of(format_report_page(report)));
  const auto& shown = json.at("scene").at(0).at("tracks").at(0).at("poses");
  EXPECT_LE(shown.size(), 20'001U);
  EXPECT_GE(shown.size(), 15'000U);
  EXPECT_EQ(shown.back().at(1), 90.0);
  EXPECT_EQ(json.at("summary").at("submaps").at(0).at("tracks").at(0).at("poses"), 90'001);
}

}  // namespace
}  // namespace waymark
