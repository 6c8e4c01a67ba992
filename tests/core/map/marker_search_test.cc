#include "core/map/marker_search.h"

#include <gtest/gtest.h>

#include "tests/support/small_map.h"

namespace waymark {
namespace {

MarkerId id(int number) { return {Family::tag36h11, number}; }

TEST(MarkerSearch, FindsInAllSubMapsInTheOrderAsked) {
  const MarkerMap map = test::small_map();
  const auto found = find_markers(map, "a.map", std::vector{id(7), id(12)});
  ASSERT_TRUE(found);
  EXPECT_EQ((*found)[0].submap, 1U);
  EXPECT_EQ((*found)[0].marker, &map.submaps[1].markers[1]);
  EXPECT_EQ((*found)[1].submap, 0U);
  EXPECT_EQ((*found)[1].marker->id, id(12));
}

TEST(MarkerSearch, NamesWhatIsNotThereAndWhatIs) {
  const auto found = find_markers(test::small_map(), "a.map", std::vector{id(9), id(12), id(8)});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().kind, ErrorKind::bad_data);
  EXPECT_EQ(found.error().message,
            "a.map: no marker 8-9 in it; its 5 markers are 0, 3, 7, 12, 586");
}

TEST(MarkerSearch, NamesTheFamilyWhereTheMapHasNoneOfIt) {
  const auto found =
      find_markers(test::small_map(), "a.map", std::vector{MarkerId{Family::tag16h5, 3}});
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().message.find("no marker tag16h5:3"), std::string::npos);
  EXPECT_NE(found.error().message.find("tag36h11:0, tag36h11:3"), std::string::npos);
}

TEST(MarkerSearch, OfOneSubMap) {
  const MarkerMap map = test::small_map();
  EXPECT_EQ(find_marker(map.submaps[0], id(586)), &map.submaps[0].markers[2]);
  EXPECT_EQ(find_marker(map.submaps[0], id(7)), nullptr);
  EXPECT_EQ(marker_ids(map), (std::vector{id(0), id(3), id(7), id(12), id(586)}));
}

}  // namespace
}  // namespace waymark
