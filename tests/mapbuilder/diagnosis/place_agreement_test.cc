#include "mapbuilder/diagnosis/place_agreement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/marker/marker_geometry.h"
#include "tests/mapbuilder/diagnosis/measured_room.h"

namespace waymark {
namespace {

constexpr double kSigma_m = 0.003;

std::vector<MeasuredPlace> places_of(test::MeasuredRoom& room, std::size_t count) {
  std::vector<MeasuredPlace> places;
  for (const int number : room.some_markers(count)) {
    const MapMarker& marker = room.result.submaps[0].map.markers[static_cast<std::size_t>(number)];
    places.push_back({marker.world_from_marker, marker.size_m, Eigen::Vector3d::Zero(),
                      room.measured(number, kSigma_m), kSigma_m, test::MeasuredRoom::kMap_m});
  }
  return places;
}

TEST(PlaceAgreement, SoundPlacesAgreeWithoutAFault) {
  for (std::uint32_t seed = 1; seed <= 30; ++seed) {
    test::MeasuredRoom room(seed);
    const auto agreement = agreement_of(places_of(room, 4 + seed % 12), 0.01);
    ASSERT_TRUE(agreement);
    EXPECT_EQ(agreement->fault, CommonFault::none);
    EXPECT_EQ(agreement->agreeing(), agreement->off.size());
    EXPECT_NEAR(agreement->scale, 1, 0.005);
  }
}

TEST(PlaceAgreement, ACornerIsFoundOnMarkersOfAnySize) {
  for (std::uint32_t seed = 1; seed <= 24; ++seed) {
    test::MeasuredRoom room(seed);
    std::vector<MeasuredPlace> places;
    const auto corner = static_cast<std::size_t>(seed % 4);
    for (const int number : room.some_markers(5 + seed % 6)) {
      const MapMarker& marker =
          room.result.submaps[0].map.markers[static_cast<std::size_t>(number)];
      const double size_m = room.uniform(0.1, 0.5);
      places.push_back({marker.world_from_marker, size_m, Eigen::Vector3d::Zero(),
                        room.measured(number, kSigma_m, marker_corners(size_m)[corner]), kSigma_m,
                        test::MeasuredRoom::kMap_m});
    }
    const auto agreement = agreement_of(places, 0.01);
    ASSERT_TRUE(agreement) << seed;
    EXPECT_EQ(agreement->fault, CommonFault::shifted) << seed;
    EXPECT_EQ(agreement->agreeing(), places.size()) << seed;
    EXPECT_LT((agreement->shift - marker_corners(1)[corner]).norm(), 0.03) << seed;
  }
}

TEST(PlaceAgreement, HalfOfThemWrongIsNoMajority) {
  test::MeasuredRoom room(2);
  std::vector<MeasuredPlace> places = places_of(room, 8);
  for (std::size_t i = 0; i < 3; ++i) places[i].measured.x() += room.uniform(0.5, 3);
  const auto agreement = agreement_of(places, 0.01);
  ASSERT_TRUE(agreement);
  EXPECT_THAT(agreement->agrees, testing::ElementsAre(0, 0, 0, 1, 1, 1, 1, 1));
  for (MeasuredPlace& place : places) {
    place.measured += Eigen::Vector3d(room.uniform(-3, 3), room.uniform(-3, 3), 0);
  }
  EXPECT_FALSE(agreement_of(places, 0.01));
}

TEST(PlaceAgreement, PlacesOnALineTellNothing) {
  std::vector<MeasuredPlace> places(5);
  for (std::size_t i = 0; i < places.size(); ++i) {
    places[i].world_from_marker.translation.x() = static_cast<double>(i);
    places[i].measured.y() = static_cast<double>(i);
    places[i].size_m = 0.3;
    places[i].sigma = kSigma_m;
  }
  EXPECT_FALSE(agreement_of(places, 0.01));
}

}  // namespace
}  // namespace waymark
