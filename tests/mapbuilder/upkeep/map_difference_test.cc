#include "mapbuilder/upkeep/map_difference.h"

#include <gmock/gmock.h>

#include "core/map/map_check.h"
#include "core/map/map_edit.h"
#include "core/map/map_file.h"
#include "tests/support/hall_map.h"
#include "tests/support/small_map.h"

namespace waymark {
namespace {

using test::hall;
using test::seen_from;

const Rigid3 kElsewhere{so3_exp(Eigen::Vector3d(0.2, -0.1, 2.0)), {10, -3, 1}};

MarkerId id(int number) { return {Family::tag36h11, number}; }

MarkerMap map_of(std::vector<SubMap> submaps) {
  MarkerMap map;
  map.submaps = std::move(submaps);
  sort_map(map);
  EXPECT_TRUE(check_map(map));
  return map;
}

MapDifference between(const MarkerMap& old_map, const MarkerMap& new_map) {
  const auto difference = difference_of(old_map, "old.map", new_map, "new.map");
  EXPECT_TRUE(difference) << difference.error().message;
  return *difference;
}

/// Markers from `first` to `last`.
SubMap part(const SubMap& whole, int first, int last) {
  SubMap result = whole;
  std::erase_if(result.markers, [&](const MapMarker& marker) {
    return marker.id.number < first || marker.id.number > last;
  });
  return result;
}

std::vector<int> moved_in(const SubMapDifference& pair) {
  std::vector<int> numbers;
  for (const ComparedMarker& marker : pair.comparison.moved) numbers.push_back(marker.id.number);
  return numbers;
}

TEST(MapDifference, TheSameMapIsTheSame) {
  const MapDifference difference = between(test::small_map(), test::small_map());
  EXPECT_TRUE(difference.same());
  ASSERT_EQ(difference.submaps.size(), 2U);
  EXPECT_EQ(difference.submaps[1].comparison.stayed.size(), 2U);
  EXPECT_EQ(difference.submaps[1].common, 2U);
}

TEST(MapDifference, NamesEverythingAcrossFrames) {
  SubMap before = part(hall(40, 1), 0, 36);
  SubMap after = hall(40, 2);
  after.markers[5].world_from_marker.translation.z() += 0.4;
  after.markers[8].size_m = 0.162;
  after.markers[9].verified = false;
  after.markers[10].id = id(100);  // a new print in its place
  after.markers.erase(after.markers.begin() + 20);
  after.z_is_up = true;
  const MapDifference difference =
      between(map_of({before}), map_of({seen_from(after, kElsewhere)}));
  EXPECT_FALSE(difference.same());
  ASSERT_EQ(difference.submaps.size(), 1U);
  const SubMapDifference& pair = difference.submaps[0];
  EXPECT_EQ(moved_in(pair), std::vector{5});
  EXPECT_NEAR(pair.comparison.moved[0].offset_m.z(), 0.4, 0.004);
  EXPECT_EQ(difference.appeared, (std::vector{id(37), id(38), id(39)}));
  EXPECT_EQ(difference.vanished, std::vector{id(20)});
  ASSERT_EQ(difference.renamed.size(), 1U);
  EXPECT_EQ(difference.renamed[0].from, id(10));
  EXPECT_EQ(difference.renamed[0].to, id(100));
  ASSERT_EQ(difference.resized.size(), 1U);
  EXPECT_EQ(difference.resized[0].id, id(8));
  EXPECT_EQ(difference.unverified, std::vector{id(9)});
  EXPECT_TRUE(pair.new_z_is_up && !pair.old_z_is_up);
  EXPECT_GT(pair.world_shift_m, 5.0);
  EXPECT_NEAR(*pair.old_from_new_scale, 1.0, 5 * pair.scale_sigma);
  EXPECT_TRUE(pair.by_majority());
  EXPECT_TRUE(difference.not_compared.empty());
}

TEST(MapDifference, AnotherScaleIsToldAndMovesNobody) {
  const SubMap before = hall(40, 1);
  SubMap after = hall(40, 2);
  after.markers[5].world_from_marker.translation.z() += 0.4;
  for (MapMarker& marker : after.markers) marker.world_from_marker.translation *= 1.01;
  const MapDifference difference =
      between(map_of({before}), map_of({seen_from(after, kElsewhere)}));
  ASSERT_EQ(difference.submaps.size(), 1U);
  EXPECT_EQ(moved_in(difference.submaps[0]), std::vector{5});
  EXPECT_NEAR(difference.submaps[0].compared_at_scale, 1 / 1.01, 1e-4);
  EXPECT_NEAR(*difference.submaps[0].old_from_new_scale, 1 / 1.01, 1e-4);
  EXPECT_LT(difference.submaps[0].scale_sigma, 2e-5);
}

TEST(MapDifference, TheScaleOfTheSameScaleIsWithinItsSigmas) {
  int beyond = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const MapDifference difference =
        between(map_of({hall(40, 2 * seed)}), map_of({hall(40, 2 * seed + 1)}));
    const SubMapDifference& pair = difference.submaps.front();
    EXPECT_EQ(pair.compared_at_scale, 1.0) << seed;
    if (std::abs(*pair.old_from_new_scale - 1) > 2 * pair.scale_sigma) ++beyond;
  }
  EXPECT_LE(beyond, 4);  // of 20 one is expected
}

TEST(MapDifference, PartsThatWereJoinedAndThatFellApart) {
  const SubMap whole = hall(40, 1);
  const MarkerMap parts = map_of({part(whole, 0, 24), seen_from(part(whole, 25, 39), kElsewhere)});
  const MarkerMap one = map_of({seen_from(hall(40, 2), kElsewhere)});
  for (const bool joined : {true, false}) {
    const MapDifference difference = joined ? between(parts, one) : between(one, parts);
    ASSERT_EQ(difference.submaps.size(), 2U);
    EXPECT_EQ(difference.submaps[0].comparison.stayed.size(), 25U);
    EXPECT_EQ(difference.submaps[1].comparison.stayed.size(), 15U);
    EXPECT_TRUE(difference.appeared.empty() && difference.vanished.empty());
    EXPECT_TRUE(difference.not_compared.empty());
  }
}

TEST(MapDifference, AMarkerThatWentToAnotherPartIsNotCompared) {
  const SubMap first = part(hall(40, 1), 0, 24);
  const SubMap second = part(hall(40, 1), 25, 39);
  SubMap less = part(first, 0, 23);
  SubMap more = second;
  more.markers.insert(more.markers.begin(), first.markers.back());
  const MapDifference difference = between(map_of({first, second}), map_of({less, more}));
  EXPECT_EQ(difference.submaps.size(), 2U);
  EXPECT_EQ(difference.not_compared, std::vector{id(24)});
}

TEST(MapDifference, WhereMostMovedThatIsNoMajority) {
  SubMap after = hall(30, 2);
  for (std::size_t i = 0; i < 20; ++i) {  // each elsewhere
    after.markers[i].world_from_marker.translation.z() += 0.1 * static_cast<double>(i + 1);
  }
  const MapDifference difference = between(map_of({hall(30, 1)}), map_of({after}));
  EXPECT_EQ(difference.submaps[0].comparison.stayed.size(), 10U);
  EXPECT_FALSE(difference.submaps[0].by_majority());
}

TEST(MapDifference, MapsOfTwoPlacesCanNotBeCompared) {
  const auto none = difference_of(map_of({part(hall(40, 1), 0, 9)}), "old.map",
                                  map_of({part(hall(40, 1), 10, 19)}), "new.map");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(none.error().message, testing::HasSubstr("of 10 and 10 markers 0 are in both"));
  SubMap other = hall(10, 2);
  for (std::size_t i = 0; i < other.markers.size(); ++i) {
    const auto k = static_cast<double>(i);
    other.markers[i].world_from_marker.translation = Eigen::Vector3d(k * k, 3 * k, k * k * k / 9);
  }
  EXPECT_FALSE(difference_of(map_of({hall(10, 1)}), "old.map", map_of({other}), "new.map"));
}

TEST(MapDifference, WithoutCovariancesToo) {
  SubMap before = hall(10, 1);
  SubMap after = hall(10, 2);
  for (MapMarker& marker : before.markers) marker.covariance = unknown_covariance();
  after.markers[3].world_from_marker.translation.x() += 0.5;
  const MapDifference difference = between(map_of({before}), map_of({after}));
  EXPECT_EQ(moved_in(difference.submaps[0]), std::vector{3});
  EXPECT_FALSE(difference.submaps[0].comparison.moved[0].sigma_m);
  EXPECT_FALSE(difference.submaps[0].old_median_sigma_m);
}

TEST(MapDifference, ASizeDiffersBeyondWhatARulerTells) {
  for (const double size_m : {0.16019, 0.16021}) {
    SubMap after = hall(10, 1);
    after.markers[3].size_m = size_m;
    const MapDifference difference = between(map_of({hall(10, 1)}), map_of({after}));
    EXPECT_EQ(difference.resized.size(), size_m > 0.1602 ? 1U : 0U) << size_m;
  }
}

}  // namespace
}  // namespace waymark
