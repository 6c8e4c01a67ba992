#include "locd/pose/map_index.h"

#include <gtest/gtest.h>

#include "tests/support/small_map.h"

namespace waymark {
namespace {

TEST(MapIndex, FindsTheFirstSubMapsMarkersById) {
  const MapIndex index(test::small_map());
  ASSERT_EQ(index.size(), 3U);
  for (std::size_t i = 0; i < index.size(); ++i) EXPECT_EQ(index.find(index.marker(i).id), i);
  EXPECT_FALSE(index.find({Family::tag36h11, 4}));
  EXPECT_FALSE(index.find({Family::tag25h9, 3}));
  EXPECT_FALSE(index.find({Family::tag36h11, 7})) << "of the second sub-map";
}

TEST(MapIndex, RemembersQuarantinedMarkers) {
  MapIndex index(test::small_map());
  index.set_quarantined(1, true);
  EXPECT_FALSE(index.quarantined(0));
  EXPECT_TRUE(index.quarantined(1));
  index.set_quarantined(1, false);
  EXPECT_FALSE(index.quarantined(1));
}

TEST(MapIndex, WhatNobodyKnowsStandsThereAsHardlyKnown) {
  MarkerMap map = test::small_map();
  map.submaps[0].markers[2].covariance = unknown_covariance();
  const MapIndex index(map);
  EXPECT_EQ(index.unknown_covariances(), 1U);
  EXPECT_EQ(index.marker(0).covariance, map.submaps[0].markers[0].covariance);
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(MapIndex::kUnknownSigma_m * MapIndex::kUnknownSigma_m),
      Eigen::Vector3d::Constant(MapIndex::kUnknownSigma_rad * MapIndex::kUnknownSigma_rad);
  EXPECT_EQ(index.marker(2).covariance, Matrix6d(variances.asDiagonal()));
}

TEST(MapIndex, DetectorsLookForAllIdsWithTheMostFrequentSize) {
  const MarkerCatalog catalog = MapIndex(test::small_map()).catalog();
  EXPECT_EQ(catalog.size_m({Family::tag36h11, 12}), 0.121);
  EXPECT_EQ(catalog.size_m({Family::tag36h11, 3}), 0.12);
  EXPECT_EQ(catalog.size_m({Family::tag36h11, 99}), 0.12) << "an id that the map lacks";
  EXPECT_FALSE(catalog.size_m({Family::tag25h9, 3}));
  EXPECT_TRUE(inverted_families(catalog).empty());
}

TEST(MapIndex, DetectorsLookForInvertedPrintsWhereTheseAreStated) {
  const std::vector<Family> inverted{Family::tag36h11, Family::tag16h5};
  const MarkerCatalog catalog = MapIndex(test::small_map()).catalog(inverted);
  EXPECT_TRUE(catalog.shows_light_squares(Family::tag36h11));
  EXPECT_EQ(inverted_families(catalog), std::vector{Family::tag36h11});
}

}  // namespace
}  // namespace waymark
