#include "mapbuilder/commands/info_command.h"

#include <gtest/gtest.h>

#include <sstream>

#include "core/map/map_file.h"
#include "tests/support/small_map.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

class InfoCommand : public ::testing::Test {
 protected:
  InfoCommand() : hash_(content_hash(test::small_map())) {
    EXPECT_TRUE(write_map_file(folder_.path() / "a.map", test::small_map()));
  }
  [[nodiscard]] std::string info(bool json) const {
    std::ostringstream out;
    const auto status = run_info({folder_.path() / "a.map", json, {}}, out);
    EXPECT_TRUE(status) << status.error().message;
    return out.str();
  }
  /// What --distance says of a.map.
  [[nodiscard]] Expected<std::string> distance(const std::string& from, const std::string& to,
                                               bool json = false) const {
    std::ostringstream out;
    const auto status = run_info({folder_.path() / "a.map", json, std::pair{from, to}}, out);
    if (status) return out.str();
    EXPECT_EQ(out.str(), "");
    return tl::make_unexpected(status.error());
  }
  test::TemporaryFolder folder_;
  std::string hash_;
};

TEST_F(InfoCommand, AMapsTextsGiveTheTerminalNoOrders) {
  MarkerMap map = test::small_map();
  map.builder_version = "0.1\x1b[2J\n\u009b1m";
  ASSERT_TRUE(write_map_file(folder_.path() / "a.map", map));
  EXPECT_NE(info(false).find("built by         0.1\\x1b[2J\\n\\u009b1m\n"), std::string::npos);
  EXPECT_NE(info(true).find(R"("builder_version": "0.1\u001b[2J\n\u009b1m")"), std::string::npos);
}

TEST_F(InfoCommand, JsonIsAsInTheGoldenFile) {
  EXPECT_EQ(info(true), R"({
  "schema": 1,
  "container_version": 2,
  "content_hash": ")" + hash_ +
                            R"(",
  "builder_version": "0.1.0",
  "rig_fingerprint": "0123456789abcdef",
  "capture_fingerprints": [
    "00000000000000aa",
    "00000000000000bb"
  ],
  "submaps": [
    {
      "frame": "scaled",
      "z_is_up": false,
      "markers": 3,
      "not_verified": [
        586
      ],
      "families": [
        "tag36h11"
      ],
      "sizes_m": [
        0.12,
        0.121
      ],
      "extent_m": [
        4.0,
        2.25,
        1.0
      ],
      "frame_sets": 42,
      "observations": 631,
      "rejected": 3,
      "rms_px": 0.3125,
      "rms_all_px": 0.5,
      "median_sigma_m": 0.00244949,
      "largest_sigma_m": 0.00244949,
      "unknown_covariances": 0
    },
    {
      "frame": "arbitrary",
      "z_is_up": false,
      "markers": 2,
      "not_verified": [],
      "families": [
        "tag36h11"
      ],
      "sizes_m": [
        0.12
      ],
      "extent_m": [
        0.0,
        1.0,
        0.0
      ],
      "frame_sets": 5,
      "observations": 27,
      "rejected": 2,
      "rms_px": 0.25,
      "rms_all_px": 0.25,
      "median_sigma_m": 0.00244949,
      "largest_sigma_m": 0.00244949,
      "unknown_covariances": 0
    }
  ]
}
)");
}

TEST_F(InfoCommand, TextIsAsInTheGoldenFile) {
  EXPECT_EQ(info(false), "content hash     " + hash_ +
                             "\n"
                             "built by         0.1.0\n"
                             "rig              0123456789abcdef\n"
                             "captures         00000000000000aa 00000000000000bb\n"
                             "sub-maps         2\n"
                             "\n"
                             "sub-map 0\n"
                             "  frame          scaled\n"
                             "  markers        3 of tag36h11, sizes 0.12, 0.121 m\n"
                             "  extent         4.000 × 2.250 × 1.000 m\n"
                             "  sigma          2.45 mm median, 2.45 mm at most\n"
                             "  observations   631 accepted, 3 rejected, in 42 frame sets\n"
                             "  RMS            0.3125 px accepted, 0.5000 px all\n"
                             "  one view, not verified: 586\n"
                             "\n"
                             "sub-map 1\n"
                             "  frame          arbitrary\n"
                             "  markers        2 of tag36h11, sizes 0.12 m\n"
                             "  extent         0.000 × 1.000 × 0.000 m\n"
                             "  sigma          2.45 mm median, 2.45 mm at most\n"
                             "  observations   27 accepted, 2 rejected, in 5 frame sets\n"
                             "  RMS            0.2500 px accepted, 0.2500 px all\n");
}

TEST_F(InfoCommand, SaysWhatIsUnknownAndThatZIsUp) {
  MarkerMap map = test::small_map();
  map.submaps[0].z_is_up = true;
  map.submaps[0].markers[1].covariance = unknown_covariance();
  for (MapMarker& marker : map.submaps[1].markers) marker.covariance = unknown_covariance();
  const auto path = folder_.path() / "unknown.map";
  ASSERT_TRUE(write_map_file(path, map));
  std::ostringstream text;
  ASSERT_TRUE(run_info({path, false, {}}, text));
  EXPECT_NE(text.str().find("scaled, z is up"), std::string::npos) << text.str();
  EXPECT_NE(text.str().find("2.45 mm at most; unknown of 1 markers"), std::string::npos);
  EXPECT_NE(text.str().find("unknown: nothing may rely on this map"), std::string::npos);
  std::ostringstream json;
  ASSERT_TRUE(run_info({path, true, {}}, json));
  EXPECT_NE(json.str().find("\"largest_sigma_m\": null"), std::string::npos) << json.str();
}

TEST_F(InfoCommand, ADistanceIsAsInTheGoldenFiles) {
  EXPECT_EQ(*distance("3", "586"),
            "distance     4.582576 m, centre to centre\n"
            "within map   sigma 1.604 mm, the two taken as independent; 2.268 mm at most\n"
            "metric       sigma 2.268 mm at most, by measured lengths\n");
  EXPECT_EQ(*distance("tag36h11:3", "586", true), R"({
  "schema": 1,
  "from": 3,
  "to": 586,
  "submap": 0,
  "distance_m": 4.582575695,
  "sigma_m": 0.001603567,
  "sigma_bound_m": 0.002267787,
  "sigma_metric_m": 0.002267787
}
)");
}

TEST_F(InfoCommand, AScaleByStatedSizesLeavesTheMetricSigmaUnknown) {
  EXPECT_NE(distance("0", "7")->find("metric       sigma unknown: the scale rests on stated"),
            std::string::npos);
  EXPECT_NE(distance("0", "7", true)->find("\"sigma_metric_m\": null"), std::string::npos);
}

TEST_F(InfoCommand, DistancesThatCanNotBeSaid) {
  const auto why = [&](const char* from, const char* to, ErrorKind kind) {
    const auto said = distance(from, to);
    EXPECT_FALSE(said);
    EXPECT_EQ(said.error().kind, kind);
    return said.error().message;
  };
  EXPECT_NE(why("3", "13", ErrorKind::bad_data).find("no marker 13 in it; its 5 markers are 0, 3"),
            std::string::npos);
  EXPECT_NE(
      why("3", "7", ErrorKind::bad_data).find("marker 3 is in sub-map 0, marker 7 in sub-map 1"),
      std::string::npos);
  EXPECT_NE(why("3", "tag36h11:3", ErrorKind::usage).find("one marker"), std::string::npos);
  EXPECT_NE(why("3", "x", ErrorKind::bad_data).find("not a number"), std::string::npos);
}

TEST_F(InfoCommand, ABareNumberOfSeveralFamiliesIsAskedFor) {
  MarkerMap map = test::small_map();
  map.submaps[0].markers[0].id = {Family::tag16h5, 3};
  ASSERT_TRUE(write_map_file(folder_.path() / "a.map", map));
  EXPECT_NE(distance("3", "586").error().message.find("several families meet here"),
            std::string::npos);
  EXPECT_NE(distance("tag16h5:3", "tag36h11:586", true)->find("\"from\": \"tag16h5:3\""),
            std::string::npos);
}

TEST_F(InfoCommand, UnreadableMapsSayNothingOnStdout) {
  std::ostringstream out;
  const auto absent = run_info({folder_.path() / "absent.map", false, {}}, out);
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().kind, ErrorKind::no_input);
  const auto damaged = run_info({folder_.write("b.map", "WAYMARK\n"), false, {}}, out);
  ASSERT_FALSE(damaged);
  EXPECT_EQ(damaged.error().kind, ErrorKind::bad_data);
  EXPECT_EQ(out.str(), "");
}

}  // namespace
}  // namespace waymark
