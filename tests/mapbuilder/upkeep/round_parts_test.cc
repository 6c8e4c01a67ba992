#include "mapbuilder/upkeep/round_parts.h"

#include <gtest/gtest.h>

#include "tests/mapbuilder/upkeep/kept_up_room.h"

namespace waymark {
namespace {

using test::BuiltRound;
using test::id;

TEST(RoundParts, HaveTheEstimateThatTheMapWasMadeOf) {
  test::RoomToday today;
  today.options.noise_px = 0.2;
  const BuiltRound round(test::walk_through(today, 50, 0, 50));
  ASSERT_EQ(round.parts->parts().size(), 1U);
  const RoundPart& part = round.parts->parts()[0];
  const SubMap& submap = round.parts->submap_of(part);
  for (const MapMarker& marker : submap.markers) {
    const auto m = round.parts->index_of(marker.id);
    ASSERT_TRUE(m);
    const Rigid3 laid = part.world_from_estimate * *round.parts->estimate().world_from_marker[*m];
    EXPECT_LT(laid.minus(marker.world_from_marker).norm(), 1e-9);
  }
  EXPECT_EQ(round.parts->component_of(part).markers.size(), submap.markers.size());
  EXPECT_FALSE(round.parts->index_of(id(99)));
}

TEST(RoundParts, RestOnWhatTheGateAccepted) {
  test::RoomToday today;
  today.options.noise_px = 0.2;
  auto room = test::walk_through(today, 50, 0, 50);
  // One detection is of no marker's place.
  for (Eigen::Vector2d& corner : room.images[3].detections[0].corners) corner.x() += 40;
  const BuiltRound round(room);
  std::size_t accepted = 0;
  for (const ObservationResidual& residual : round.result.submaps[0].residuals) {
    accepted += residual.accepted ? 1 : 0;
  }
  EXPECT_EQ(round.parts->selection().used().size(), accepted);
  EXPECT_LT(accepted, round.observations.usable);
}

TEST(RoundParts, AreAsManyAsTheSubMaps) {
  test::RoomToday today;
  today.options.cameras = 1;
  // Two short looks to opposite walls, with nothing between.
  auto room = test::walk_through(today, 60, 0, 2);
  const auto other = test::walk_through(today, 60, 14, 16);
  room.images.insert(room.images.end(), other.images.begin(), other.images.end());
  const BuiltRound round(room);
  EXPECT_EQ(round.parts->parts().size(), round.result.submaps.size());
}

}  // namespace
}  // namespace waymark
