#include "mapbuilder/growth/marker_placement.h"

#include <cmath>
#include <limits>

#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark {
namespace {

std::vector<PlacementView> views_of(const test::PreparedRoom& room, MarkerIndex marker,
                                    std::size_t most) {
  std::vector<PlacementView> views;
  for (const ObservationIndex index : room.selection.used_of(marker)) {
    if (views.size() == most) break;
    const Observation& o = room.observations[index];
    const RigCamera& camera = room.truth.calibration.camera(room.observations, o);
    views.push_back({&room.prepared[index], &camera.model, camera.rig_from_cam.inverse(),
                     room.truth.world_from_rig[o.frame_set]->best.pose, std::nullopt});
  }
  return views;
}

TEST(MarkerPlacement, PlacesAMarkerByItsViews) {
  const auto room = test::make_room({});
  const test::PreparedRoom prepared(room);
  for (std::size_t m = 0; m < prepared.observations.markers.size(); m += 5) {
    const auto views = views_of(prepared, MarkerIndex(m), 6);
    ASSERT_GE(views.size(), 2U);
    const auto estimate = place_marker(views, {});
    ASSERT_TRUE(estimate);
    EXPECT_LT(estimate->best.pose.minus(room.world_from_marker[m]).norm(), 1e-5);
    EXPECT_GT(estimate->gap, 1);  // in sigmas² of 1 px: the flip explains the views worse
  }
}

TEST(MarkerPlacement, AnAmbiguousRigsOtherPoseIsTriedToo) {
  const auto room = test::make_room({});
  const test::PreparedRoom prepared(room);
  auto views = views_of(prepared, MarkerIndex(3), 3);
  ASSERT_EQ(views.size(), 3U);
  // The first view's rig pose is wrong, its runner-up right.
  views[0].other_world_from_rig = views[0].world_from_rig;
  views[0].world_from_rig.translation += Eigen::Vector3d(0.5, 0, 0.2);
  const auto estimate = place_marker(views, {});
  ASSERT_TRUE(estimate);
  EXPECT_LT(estimate->best.pose.minus(room.world_from_marker[3]).norm(), 1e-5);
}

TEST(MarkerPlacement, WithoutViewsThereIsNoPlaceAndWithoutRunnerUpNoGap) {
  EXPECT_FALSE(place_marker({}, {}));
  EXPECT_EQ(PlacementEstimate{}.gap, std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace waymark
