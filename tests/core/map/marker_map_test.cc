#include "core/map/marker_map.h"

#include <gtest/gtest.h>

#include "tests/support/small_map.h"

namespace waymark {
namespace {

TEST(MarkerMap, KnowsWhichFamiliesMeetInAllOfItsSubMaps) {
  MarkerMap map = test::small_map();
  EXPECT_FALSE(map.several_families());
  EXPECT_EQ(map.families().only(), Family::tag36h11);
  map.submaps[1].markers[0].id.family = Family::tag25h9;
  EXPECT_TRUE(map.several_families());
  EXPECT_FALSE(map.families().only());
  EXPECT_FALSE(MarkerMap{}.several_families());
  EXPECT_FALSE(MarkerMap{}.families().only());
}

}  // namespace
}  // namespace waymark
