#include "mapbuilder/observations/covisibility.h"

#include "tests/mapbuilder/observations/bare_observations.h"

namespace waymark {
namespace {

std::vector<std::size_t> numbers(const std::vector<MarkerIndex>& indices) {
  std::vector<std::size_t> values;
  for (const MarkerIndex index : indices) values.push_back(index.value());
  return values;
}

TEST(Covisibility, FindsTheComponentsTheLargestFirst) {
  const auto observations = test::bare_observations({{0, 0}, {1, 1}, {1, 2}, {2, 2}, {2, 3}}, 4, 5);
  const Selection selection(observations);
  const auto& components = selection.components();
  ASSERT_EQ(components.size(), 2U);
  EXPECT_EQ(numbers(components.front().markers), (std::vector<std::size_t>{1, 2, 3}));
  EXPECT_EQ(components.front().frame_sets,
            (std::vector<FrameSetIndex>{FrameSetIndex(1), FrameSetIndex(2)}));
  EXPECT_EQ(numbers(components.back().markers), (std::vector<std::size_t>{0}));
  EXPECT_EQ(selection.component_of(FrameSetIndex(0)), ComponentIndex(1));
  EXPECT_FALSE(selection.component_of(FrameSetIndex(3)));
}

TEST(Covisibility, AnUnusedObservationConnectsNothing) {
  const auto observations = test::bare_observations({{0, 0}, {0, 1}, {1, 1}, {1, 2}}, 2, 3);
  EXPECT_EQ(Selection(observations).components().size(), 1U);
  Corrections corrections;
  corrections.left_out.insert(ObservationIndex(2));
  EXPECT_EQ(Selection(observations, corrections).components().size(), 2U);
}

TEST(Covisibility, TheSeedSeesMostMarkersAndThenTheLargest) {
  const auto observations =
      test::bare_observations({{0, 0}, {1, 1}, {1, 2}, {2, 0}, {2, 3}, {2, 3}}, 3, 4);
  const Selection selection(observations);
  Component everything;
  for (const FrameSetIndex f : observations.frame_sets.indices())
    everything.frame_sets.push_back(f);
  // Frame sets 1 and 2 both see two different markers; 2 shows one of them twice and more of it.
  EXPECT_EQ(choose_seed(selection, everything), FrameSetIndex(2));
}

}  // namespace
}  // namespace waymark
