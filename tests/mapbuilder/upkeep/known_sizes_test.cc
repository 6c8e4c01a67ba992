#include "mapbuilder/upkeep/known_sizes.h"

#include <gtest/gtest.h>

#include "tests/support/hall_map.h"

namespace waymark {
namespace {

MarkerId id(int number) { return {Family::tag36h11, number}; }

MarkerCatalog catalog() {
  MarkerCatalog::FamilyEntry entry;
  entry.family = Family::tag36h11;
  entry.default_size_m = 0.16;
  entry.size_m_by_id = {{3, 0.25}, {4, 0.25}, {5, 0.20}};
  return MarkerCatalog({entry});
}

/// Marker 0 and 1 of 0.16 m, 3 of 0.25 m.
MarkerMap map_with(double size_0_m, double size_3_m) {
  MarkerMap map;
  map.submaps = {test::hall(4, 1)};
  std::vector<MapMarker>& markers = map.submaps[0].markers;
  markers.erase(markers.begin() + 2);
  markers[0].size_m = markers[1].size_m = size_0_m;
  markers[2].stated_size_m = 0.25;
  markers[2].size_m = size_3_m;
  return map;
}

TEST(KnownSizes, AreTheStatedOnesWhereNothingWasChanged) {
  const MarkerCatalog same = with_sizes_of(map_with(0.16, 0.25), catalog());
  EXPECT_EQ(same.fingerprint(), catalog().fingerprint());
}

TEST(KnownSizes, AreTheMapsOfItsMarkersAndOfOthersByTheSameFactor) {
  const MarkerCatalog known = with_sizes_of(map_with(0.168, 0.25), catalog());
  EXPECT_DOUBLE_EQ(*known.size_m(id(0)), 0.168);
  EXPECT_DOUBLE_EQ(*known.size_m(id(77)), 0.168);  // not in the map, of the same stated size
  EXPECT_DOUBLE_EQ(*known.size_m(id(3)), 0.25);
  EXPECT_DOUBLE_EQ(*known.size_m(id(5)), 0.20);  // of a size that the map says nothing of
}

TEST(KnownSizes, WhatIsStatedOtherwiseNowIsAsStated) {
  const MarkerMap map = map_with(0.168, 0.255);
  MarkerCatalog::FamilyEntry entry = catalog().entries()[0];
  entry.size_m_by_id[3] = 0.30;  // printed anew
  const MarkerCatalog known = with_sizes_of(map, MarkerCatalog({entry}));
  EXPECT_DOUBLE_EQ(*known.size_m(id(3)), 0.30);
  EXPECT_DOUBLE_EQ(*known.size_m(id(4)), 0.255);
}

}  // namespace
}  // namespace waymark
