#include "mapbuilder/growth/placement_queue.h"

#include <set>

#include "mapbuilder/growth/frame_set_localization.h"
#include "mapbuilder/observations/covisibility.h"
#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark {
namespace {

class Queue : public testing::Test {
 protected:
  Queue() {
    for (auto& marker : estimate.world_from_marker) marker.reset();
    for (auto& rig : estimate.world_from_rig) rig.reset();
    estimate.world_from_rig[seed] = known.truth.world_from_rig[seed];
  }

  test::PreparedRoom known{test::make_room({})};
  const Component& component = known.selection.components().front();
  FrameSetIndex seed = choose_seed(known.selection, component);
  MapperOptions options = effective({});
  Estimate estimate = known.truth;
};

TEST_F(Queue, OffersWhatTheSeedSeesWhereItStands) {
  PlacementQueue queue(known.selection, component, seed, options);
  queue.take_pose_of(seed, estimate);
  const auto next = queue.next(known.prepared, estimate);
  ASSERT_FALSE(next.empty());
  for (const PlacedMarker& placed : next) {
    EXPECT_LT(placed.world_from_marker.minus(*known.truth.world_from_marker[placed.marker]).norm(),
              1e-3);
  }
}

TEST_F(Queue, EndsWhenEverythingSeenIsTakenOut) {
  PlacementQueue queue(known.selection, component, seed, options);
  queue.take_pose_of(seed, estimate);
  std::set<MarkerIndex> seen;
  for (const ObservationIndex index : known.selection.used_in(seed)) {
    seen.insert(known.observations[index].marker);
  }
  std::set<MarkerIndex> offered;
  for (auto next = queue.next(known.prepared, estimate); !next.empty();
       next = queue.next(known.prepared, estimate)) {
    for (const PlacedMarker& placed : next) {
      queue.remove(placed.marker);
      EXPECT_TRUE(offered.insert(placed.marker).second) << "offered twice";
    }
  }
  EXPECT_EQ(offered, seen);
}

TEST_F(Queue, FrameSetsAreLocalizedAgainstWhatIsPlaced) {
  estimate.world_from_marker = known.truth.world_from_marker;
  std::vector<FrameSetIndex> others;
  for (const FrameSetIndex f : component.frame_sets) {
    if (f != seed) others.push_back(f);
  }
  EXPECT_EQ(unadjusted_frame_sets(known.selection, others, estimate), others);
  const Estimate localized = localize(known.prepared, others, options, estimate);
  for (const FrameSetIndex f : others) {
    ASSERT_TRUE(localized.world_from_rig[f]);
    EXPECT_LT(localized.world_from_rig[f]
                  ->best.pose.minus(known.truth.world_from_rig[f]->best.pose)
                  .norm(),
              1e-3);
  }
  EXPECT_TRUE(unadjusted_frame_sets(known.selection, others, localized).empty());
}

}  // namespace
}  // namespace waymark
