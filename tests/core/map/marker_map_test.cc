#include "core/map/marker_map.h"

#include <gtest/gtest.h>

#include "core/geometry/decompositions.h"
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

TEST(MarkerMap, AMarkersOwnUncertaintyIsWhatNoModeExplains) {
  MapMarker marker = test::considered_small_map().submaps[0].markers[0];
  EXPECT_TRUE(marker.considered());
  EXPECT_TRUE(marker.own_covariance().isApprox(marker.covariance, 1e-9));
  // A little more in the modes than there is, as floats have it, leaves none, and no less.
  marker.modes *= 2;
  EXPECT_GE(symmetric_eigenvalues<6>(marker.own_covariance()).minCoeff(), -1e-18);
  marker = test::small_map().submaps[0].markers[0];
  EXPECT_EQ(marker.own_covariance(), marker.covariance) << "nothing is considered";
  marker.covariance = unknown_covariance();
  EXPECT_TRUE(marker.own_covariance().array().isNaN().all());
}

TEST(MarkerMap, AnotherWorldTurnsAllThatIsKnown) {
  MapMarker marker = test::considered_small_map().submaps[0].markers[0];
  const Matrix6d own = marker.own_covariance();
  Rigid3 motion;
  motion.rotation = so3_exp({0.2, -0.4, 1});
  motion.translation = {3, 1, -2};
  const Matrix6d turn = left_motion_jacobian(motion);
  const Matrix6d metric = turn * marker.covariance_metric * turn.transpose();
  move_marker(motion, marker);
  EXPECT_TRUE(marker.covariance_metric.isApprox(metric, 1e-12));
  EXPECT_TRUE(marker.own_covariance().isApprox(turn * own * turn.transpose(), 1e-5));
  move_marker(motion.inverse(), marker);
  EXPECT_LT(marker.world_from_marker
                .minus(test::considered_small_map().submaps[0].markers[0].world_from_marker)
                .norm(),
            1e-12);
}

}  // namespace
}  // namespace waymark
