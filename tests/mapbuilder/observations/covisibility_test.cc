#include "mapbuilder/observations/covisibility.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

/// A table of bare observations (frame set, marker), rising.
ObservationTable table_of(const std::vector<std::pair<int, int>>& pairs, int frame_sets,
                          int markers) {
  ObservationTable table;
  table.markers.resize(static_cast<std::size_t>(markers));
  table.frame_sets.resize(static_cast<std::size_t>(frame_sets));
  for (const auto& [frame_set, marker] : pairs) {
    TableObservation o;
    o.frame_set = frame_set;
    o.marker = marker;
    o.corners_px = {{{0, 0}, {10.0 + marker, 0}, {10, 10}, {0, 10}}};
    TableFrameSet& set = table.frame_sets[static_cast<std::size_t>(frame_set)];
    if (set.observation_count++ == 0) set.first_observation = table.observations.size();
    table.observations.push_back(o);
  }
  return table;
}

TEST(Covisibility, FindsThePartsTheLargestFirst) {
  const auto table = table_of({{0, 0}, {1, 1}, {1, 2}, {2, 2}, {2, 3}}, 4, 5);
  const auto components = connected_components(table, std::vector<char>(5, 1));
  ASSERT_EQ(components.size(), 2U);
  EXPECT_EQ(components[0].markers, (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(components[0].frame_sets, (std::vector<int>{1, 2}));
  EXPECT_EQ(components[1].markers, (std::vector<int>{0}));
}

TEST(Covisibility, AnUnusedObservationConnectsNothing) {
  const auto table = table_of({{0, 0}, {0, 1}, {1, 1}, {1, 2}}, 2, 3);
  EXPECT_EQ(connected_components(table, {1, 1, 1, 1}).size(), 1U);
  EXPECT_EQ(connected_components(table, {1, 1, 0, 1}).size(), 2U);
}

TEST(Covisibility, TheSeedSeesMostMarkersAndThenTheLargest) {
  const auto table = table_of({{0, 0}, {1, 1}, {1, 2}, {2, 0}, {2, 3}, {2, 3}}, 3, 4);
  Component everything{{0, 1, 2}, {0, 1, 2, 3}};
  EXPECT_EQ(choose_seed(table, everything), 2);
  // Frame set 1 and 2 both see two different markers; 2 shows one of them twice and more of it.
}

}  // namespace
}  // namespace waymark
