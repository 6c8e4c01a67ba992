#include "core/map/map_edit.h"

#include <gmock/gmock.h>

#include "core/map/map_check.h"
#include "core/map/map_file.h"
#include "core/map/marker_search.h"
#include "tests/support/small_map.h"

namespace waymark {
namespace {

using testing::HasSubstr;

MarkerId id(int number) { return {Family::tag36h11, number}; }

MarkerMap edited(const MapEdit& edit) {
  const auto map = edit_map(test::small_map(), "a.map", edit);
  EXPECT_TRUE(map) << map.error().message;
  EXPECT_TRUE(check_map(*map));
  return *map;
}

Error refused(const MapEdit& edit) {
  const auto map = edit_map(test::small_map(), "a.map", edit);
  EXPECT_FALSE(map);
  return map ? Error(ErrorKind::internal, "") : map.error();
}

TEST(MapEdit, RemovesAndKeepsSubMapsByFallingMarkerCount) {
  const MarkerMap map = edited({{id(3), id(586)}, {}, {}});
  EXPECT_EQ(marker_ids(map), (std::vector{id(0), id(7), id(12)}));
  ASSERT_EQ(map.submaps.size(), 2U);
  EXPECT_EQ(map.submaps[0].markers.size(), 2U);
  EXPECT_EQ(map.submaps[1].markers[0].id, id(12));
  EXPECT_EQ(map.submaps[1].frame, FrameKind::scaled);
}

TEST(MapEdit, ASubMapThatLosesAllIsGone) {
  const MarkerMap map = edited({{id(0), id(7)}, {}, {}});
  ASSERT_EQ(map.submaps.size(), 1U);
  EXPECT_EQ(map.submaps[0].markers.size(), 3U);
}

TEST(MapEdit, NoMarkerLeftIsNoMap) {
  const Error error = refused({marker_ids(test::small_map()), {}, {}});
  EXPECT_EQ(error.kind, ErrorKind::bad_data);
  EXPECT_THAT(error.message, HasSubstr("no marker would be left"));
}

TEST(MapEdit, RenamesAndNothingElseOfTheMarkerChanges) {
  const MarkerMap map = edited({{}, {{id(3), id(300)}}, {}});
  EXPECT_EQ(find_marker(map.submaps[0], id(3)), nullptr);
  const MapMarker* renamed = find_marker(map.submaps[0], id(300));
  ASSERT_NE(renamed, nullptr);
  const MarkerMap before = test::small_map();
  EXPECT_EQ(renamed->observations, before.submaps[0].markers[0].observations);
  EXPECT_EQ(renamed->covariance, before.submaps[0].markers[0].covariance);
}

TEST(MapEdit, TwoMayChangePlacesAlsoAcrossSubMaps) {
  const MarkerMap before = test::small_map();
  const MarkerMap map = edited({{}, {{id(3), id(7)}, {id(7), id(3)}}, {}});
  EXPECT_EQ(find_marker(map.submaps[0], id(7))->observations,
            before.submaps[0].markers[0].observations);
  EXPECT_EQ(find_marker(map.submaps[1], id(3))->observations,
            before.submaps[1].markers[1].observations);
}

TEST(MapEdit, ANameThatIsTakenIsRefusedUnlessItsMarkerGoes) {
  const Error error = refused({{}, {{id(3), id(7)}}, {}});
  EXPECT_EQ(error.kind, ErrorKind::bad_data);
  EXPECT_THAT(error.message, HasSubstr("two markers 7"));
  EXPECT_EQ(marker_ids(edited({{id(7)}, {{id(3), id(7)}}, {}})),
            (std::vector{id(0), id(7), id(12), id(586)}));
}

TEST(MapEdit, AcceptsWhatOneViewHasPlaced) {
  ASSERT_FALSE(test::small_map().submaps[0].markers[2].verified);
  const MarkerMap map = edited({{}, {{id(586), id(585)}}, {id(586)}});
  const MapMarker* accepted = find_marker(map.submaps[0], id(585));
  EXPECT_TRUE(accepted->verified);
  EXPECT_EQ(accepted->covariance, test::small_map().submaps[0].markers[2].covariance);
}

TEST(MapEdit, UnknownIdsAreNamedTogether) {
  const Error error = refused({{id(3), id(4)}, {{id(8), id(9)}}, {id(10)}});
  EXPECT_EQ(error.kind, ErrorKind::bad_data);
  EXPECT_THAT(error.message, HasSubstr("no marker 4, 8, 10 in it"));
}

TEST(MapEdit, WhatContradictsItselfIsRefused) {
  const MarkerId other{Family::tag16h5, 3};
  for (const MapEdit& edit : std::vector<MapEdit>{
           {{id(3)}, {{id(3), id(4)}}, {}},
           {{id(3)}, {}, {id(3)}},
           {{}, {{id(3), id(3)}}, {}},
           {{}, {{id(3), id(4)}, {id(3), id(5)}}, {}},
           {{}, {{id(3), id(4)}, {id(12), id(4)}}, {}},
           {{}, {{id(3), other}}, {}},
       }) {
    EXPECT_EQ(refused(edit).kind, ErrorKind::usage);
  }
}

TEST(MapEdit, ThereAndBackIsTheSameMap) {
  const auto there = edit_map(test::small_map(), "a.map", {{}, {{id(3), id(4)}}, {}});
  ASSERT_TRUE(there);
  const auto back = edit_map(*there, "b.map", {{}, {{id(4), id(3)}}, {}});
  ASSERT_TRUE(back);
  EXPECT_EQ(content_hash(*back), content_hash(test::small_map()));
}

}  // namespace
}  // namespace waymark
