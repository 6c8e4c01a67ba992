#include "core/map/map_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/map/map_file.h"
#include "tests/support/small_map.h"

namespace waymark {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const std::string kByHand = R"({
  "schema": 1,
  "submaps": [{"markers": [
    {"id": 7, "family": "aruco_original", "size_m": 0.2, "position_m": [1, 2.5, 0],
     "quaternion_xyzw": [0, 0, 0.7071, 0.7071]},
    {"id": "3", "family": "aruco_original", "size_m": 0.2, "position_m": [0, 0, 0],
     "quaternion_xyzw": [0, 0, 0, 1]}
  ]}]
})";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string refusal(const std::string& text) {
  const auto map = parse_map_json(text, "map.json");
  if (map) return "accepted";
  EXPECT_EQ(map.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(map.error().message, AllOf(StartsWith("map.json: "), Not(HasSubstr("\n"))));
  return map.error().message;
}

TEST(MapJson, GoldenForm) {
  MarkerMap map = test::small_map();
  map.submaps.pop_back();
  map.submaps[0].markers.erase(map.submaps[0].markers.begin() + 1, map.submaps[0].markers.end());
  EXPECT_EQ(format_map_json(map), replaced(R"({
  "schema": 1,
  "builder_version": "0.1.0",
  "content_hash": "HASH",
  "rig_fingerprint": "0123456789abcdef",
  "capture_fingerprints": ["00000000000000aa","00000000000000bb"],
  "submaps": [
    {
      "frame": "scaled",
      "z_is_up": false,
      "frame_sets": 42,
      "rms_px": 0.3125,
      "rms_all_px": 0.5,
      "markers": [
        {"id":3,"family":"tag36h11","size_m":0.12,"stated_size_m":0.12,"position_m":[0.0,0.0,0.0],"quaternion_xyzw":[0.0,0.0,0.0,1.0],"covariance":[1e-06,0.0,0.0,0.0,-2.5e-07,0.0,0.0,2e-06,0.0,0.0,0.0,0.0,0.0,0.0,3e-06,0.0,0.0,0.0,0.0,0.0,0.0,4e-07,0.0,0.0,-2.5e-07,0.0,0.0,0.0,5e-07,0.0,0.0,0.0,0.0,0.0,0.0,6e-07],"covariance_metric":[1e-06,0.0,0.0,0.0,-2.5e-07,0.0,0.0,2e-06,0.0,0.0,0.0,0.0,0.0,0.0,3e-06,0.0,0.0,0.0,0.0,0.0,0.0,4e-07,0.0,0.0,-2.5e-07,0.0,0.0,0.0,5e-07,0.0,0.0,0.0,0.0,0.0,0.0,6e-07],"observations":13,"rejected":1,"rms_px":0.25,"verified":true}
      ]
    }
  ]
}
)",
                                           "HASH", content_hash(map)));
}

TEST(MapJson, ReadsBackToTheSameBytes) {
  const auto back = parse_map_json(format_map_json(test::small_map()), "map.json");
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(*encode_map(*back), *encode_map(test::small_map()));
}

TEST(MapJson, WhatAMapConsidersReadsBackToTheSameBytes) {
  const std::string text = format_map_json(test::considered_small_map());
  EXPECT_THAT(text, HasSubstr("{\"name\":\"cam0 focal length\",\"serial\":\"00417\""));
  const auto back = parse_map_json(text, "map.json");
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(*encode_map(*back), *encode_map(test::considered_small_map()));
  EXPECT_THAT(refusal(replaced(text, "\"modes\":[0.001953125,", "\"modes\":[9,")),
              HasSubstr("modes are more than its metric covariance"));
  EXPECT_THAT(refusal(replaced(text, "\"parameter_covariance\": [1e-06,2.5e-07,4e-06]",
                               "\"parameter_covariance\": [1e-06,1,4e-06]")),
              HasSubstr("the parameters' covariance is none"));
}

TEST(MapJson, SeveralFamiliesQualifyTheirIds) {
  MarkerMap map = test::small_map();
  map.submaps[1].markers[1].id = {Family::tag25h9, 7};
  std::swap(map.submaps[1].markers[0], map.submaps[1].markers[1]);
  ASSERT_TRUE(map.several_families());
  const std::string text = format_map_json(map);
  EXPECT_THAT(text, HasSubstr(R"("id":"tag36h11:12","family":"tag36h11")"));
  EXPECT_THAT(text, HasSubstr(R"("id":"tag25h9:7","family":"tag25h9")"));
  const auto back = parse_map_json(text, "map.json");
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(*encode_map(*back), *encode_map(map));
}

TEST(MapJson, AMapMeasuredByHandIsShort) {
  const auto map = parse_map_json(kByHand, "map.json");
  ASSERT_TRUE(map) << map.error().message;
  ASSERT_EQ(map->submaps.size(), 1U);
  const SubMap& submap = map->submaps[0];
  EXPECT_EQ(submap.frame, FrameKind::arbitrary);
  ASSERT_EQ(submap.markers.size(), 2U);
  EXPECT_EQ(submap.markers[0].id, (MarkerId{Family::aruco_original, 3}));
  const MapMarker& marker = submap.markers[1];
  EXPECT_EQ(marker.size_m, 0.2);
  EXPECT_EQ(marker.stated_size_m, 0.2);
  EXPECT_EQ(marker.world_from_marker.translation, Eigen::Vector3d(1, 2.5, 0));
  EXPECT_NEAR(marker.world_from_marker.rotation.norm(), 1, 1e-15);
  EXPECT_FALSE(marker.covariance_known());
  EXPECT_FALSE(submap.z_is_up);
  EXPECT_TRUE(marker.verified);
  EXPECT_EQ(marker.observations, 0U);
  EXPECT_TRUE(encode_map(*map));
}

TEST(MapJson, SubmapsAndMarkersAreSorted) {
  const std::string two = replaced(
      kByHand, R"("submaps": [)",
      R"("submaps": [{"frame": "facility", "markers": [{"id": 1, "family": "aruco_original",
          "size_m": 0.2, "position_m": [0, 0, 0], "quaternion_xyzw": [0, 0, 0, 1]}]}, )");
  const auto map = parse_map_json(two, "map.json");
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->submaps[0].markers.size(), 2U);
  EXPECT_EQ(map->submaps[1].frame, FrameKind::facility);
  EXPECT_TRUE(map->submaps[1].z_is_up) << "the facility's z is up unless somebody says otherwise";
}

TEST(MapJson, SigmasStandForACovarianceOfAMapMeasuredByHand) {
  const auto map =
      parse_map_json(replaced(kByHand, R"("position_m": [1, 2.5, 0])",
                              R"("position_m": [1, 2.5, 0], "sigma_m": 0.005, "sigma_deg": 0.5)"),
                     "map.json");
  ASSERT_TRUE(map) << map.error().message;
  const auto& markers = map->submaps[0].markers;
  EXPECT_FALSE(markers[0].covariance_known());
  ASSERT_TRUE(markers[1].covariance_known());
  EXPECT_NEAR(markers[1].covariance(2, 2), 25e-6, 1e-15);
  EXPECT_NEAR(std::sqrt(markers[1].covariance(4, 4)), 0.5 * 3.14159265358979 / 180, 1e-12);
  EXPECT_EQ(markers[1].covariance(0, 1), 0);
}

TEST(MapJson, UnknownCovariancesAreNullAndStayUnknown) {
  MarkerMap map = test::small_map();
  map.submaps[0].markers[0].covariance = unknown_covariance();
  map.submaps[1].z_is_up = true;
  const std::string text = format_map_json(map);
  EXPECT_THAT(text, HasSubstr(R"("covariance":null)"));
  const auto back = parse_map_json(text, "map.json");
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(*encode_map(*back), *encode_map(map));
}

struct BadJson {
  std::string from;
  std::string to;
  std::string message;
};

std::ostream& operator<<(std::ostream& out, const BadJson& bad) {
  return out << bad.from << " -> " << bad.to;
}

class BadMapJson : public ::testing::TestWithParam<BadJson> {};

TEST_P(BadMapJson, IsRefusedWithPlaceAndReason) {
  EXPECT_THAT(refusal(replaced(kByHand, GetParam().from, GetParam().to)),
              HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    MapJson, BadMapJson,
    ::testing::Values(
        BadJson{"\"size_m\": 0.2,", "\"size_m\": 0.2, \"sigma_m\": 0.01,",
                "\"sigma_deg\" is missing"},
        BadJson{"\"size_m\": 0.2,", "\"size_m\": 0.2, \"sigma_m\": 0, \"sigma_deg\": 1,",
                "sigma_m: 0 is not within"},
        BadJson{"\"size_m\": 0.2,",
                "\"size_m\": 0.2, \"sigma_m\": 1, \"sigma_deg\": 1, \"covariance\": null,",
                "both a covariance and sigmas"},
        BadJson{"\"submaps\": [{", "\"submaps\": [{\"frame\": \"facility\", \"z_is_up\": false,",
                "z is not up"},
        BadJson{"\"schema\": 1", "\"schema\": 2", "schema 2 is not 1"},
        BadJson{"\"schema\": 1", "\"schema\": 0", "schema 0 is not 1"},
        BadJson{"\"schema\": 1", "\"schema\": \"1\"", "schema: is no whole number"},
        BadJson{"\"schema\": 1,", "", "\"schema\" is missing"},
        BadJson{"\"schema\": 1", "\"schema\": 1, \"scheme\": 1", "unknown key \"scheme\""},
        BadJson{"\"submaps\"", "\"markers\"", "unknown key \"markers\""},
        BadJson{"\"submaps\": [", "\"submaps\": 3, \"rig_fingerprint\": [",
                "rig_fingerprint: is no text"},
        BadJson{"{\"markers\"", "{\"frame\": \"moon\", \"markers\"",
                "submaps[0].frame: is not one of"},
        BadJson{"{\"markers\"", "{\"frame_sets\": -1, \"markers\"",
                "submaps[0].frame_sets: is no whole number"},
        BadJson{"{\"markers\"", "{\"frame_sets\": 4294967296, \"markers\"",
                "submaps[0].frame_sets: is no whole number"},
        BadJson{"\"id\": 7, ", "", "submaps[0].markers[0]: \"id\" is missing"},
        BadJson{"\"id\": 7", "\"id\": 7.5", "submaps[0].markers[0].id: "},
        BadJson{"\"id\": 7", "\"id\": -7", "submaps[0].markers[0].id: "},
        BadJson{"\"id\": 7", "\"id\": 4294967303", "submaps[0].markers[0].id: "},
        BadJson{"\"id\": 7", "\"id\": 7, \"id\": 8", "\"id\" stands there twice"},
        BadJson{"\"id\": 7", "\"id\": [[[[[[7]]]]]]", "nested deeper than 8 levels"},
        BadJson{"\"id\": 7", "\"id\": 1024", "submaps[0].markers[0].id: "},
        BadJson{"\"id\": 7", "\"id\": \"tag36h11:7\"", "the family is not the one"},
        BadJson{"\"id\": 7", "\"id\": 3", "marker aruco_original:3: stands there twice"},
        BadJson{"aruco_original", "aruco", "unknown family \"aruco\""},
        BadJson{"\"family\": \"aruco_original\", ", "", "\"family\" is missing"},
        BadJson{"\"size_m\": 0.2", "\"size_m\": -0.2", "size is not within"},
        BadJson{"\"size_m\": 0.2", "\"size_m\": \"0.2\"", "markers[0].size_m: is no number"},
        BadJson{"\"size_m\": 0.2", "\"size_mm\": 200", "unknown key \"size_mm\""},
        BadJson{"[1, 2.5, 0]", "[1, 2.5]", "position_m: is no list of 3 numbers"},
        BadJson{"[1, 2.5, 0]", "[1, null, 0]", "position_m[1]: is no number"},
        BadJson{"[1, 2.5, 0]", "[1, 1e999, 0]", "not valid JSON"},
        BadJson{"[1, 2.5, 0]", "[1, NaN, 0]", "not valid JSON"},
        BadJson{"0.7071, 0.7071", "0.7071, 0.75", "quaternion of norm"},
        BadJson{"0.7071, 0.7071", "0, 0", "quaternion of norm 0"},
        BadJson{"\"id\": 7", "\"verified\": 1, \"id\": 7", "neither true nor false"},
        BadJson{"\"id\": 7", "\"covariance\": [1], \"id\": 7", "no list of 36 numbers"},
        BadJson{"]}]\n}", "]}]\n", "not valid JSON"}));

TEST(MapJson, WhatIsNoMapIsRefused) {
  for (const auto* text : {"", "[]", "3", "{}", "null", "\"map\"", "{\"schema\":1,\"submaps\":[]}",
                           "{\"schema\":1,\"submaps\":[{\"markers\":[]}]}",
                           "{\"schema\":1,\"submaps\":[1]}", "\xFF\xFE{}"}) {
    EXPECT_NE(refusal(text), "accepted") << text;
  }
}

TEST(MapJson, EveryTruncationIsRefused) {
  const std::string text = format_map_json(test::small_map());
  for (std::size_t length = 0; length + 2 < text.size(); ++length) {
    ASSERT_NE(refusal(text.substr(0, length)), "accepted") << length;
  }
}

}  // namespace
}  // namespace waymark
