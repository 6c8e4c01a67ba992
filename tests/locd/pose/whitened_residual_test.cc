#include "locd/pose/whitened_residual.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/small_map.h"
#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

class WhitenedResiduals : public testing::Test {
 protected:
  WhitenedResiduals() {
    o_.map_index = 0;
    o_.observation.camera = 1;
    o_.observation.size_m = map_.marker(0).size_m;
    const auto x = marker_corners(o_.observation.size_m);
    const Rigid3 cam_from_marker =
        solver_.cam_from_rig(1) * world_from_rig_.inverse() * map_.marker(0).world_from_marker;
    for (std::size_t i = 0; i < 4; ++i) {
      o_.observation.corners_px[i] = *solver_.model(1).project(cam_from_marker * x[i]) +
                                     Eigen::Vector2d(1.0 + static_cast<double>(i), -2.0);
      o_.observation.whitening[i] << 2.0, 0.0, 0.5, 3.0;
    }
  }

  /// A camera looks at the map's first marker, whose front looks along +z, from 2 m.
  Rig rig_ = test::ring_rig(2);
  MapIndex map_{test::small_map()};
  RigPoseSolver solver_{rig_, {}};
  Rigid3 cam_from_marker_{so3_exp({M_PI, 0.2, 0.1}), {0.05, -0.1, 2}};
  Rigid3 world_from_rig_ =
      map_.marker(0).world_from_marker * cam_from_marker_.inverse() * solver_.cam_from_rig(1);
  SetObservation o_;
};

TEST_F(WhitenedResiduals, AreTheCornersResidualsInSigmas) {
  const auto w = whitened_residual(o_, map_, solver_, world_from_rig_);
  ASSERT_TRUE(w);
  for (Eigen::Index i = 0; i < 4; ++i) {
    const Eigen::Vector2d off(1.0 + static_cast<double>(i), -2.0);
    const Eigen::Vector2d expected(2 * off.x(), 0.5 * off.x() + 3 * off.y());
    EXPECT_LT((w->residual.segment<2>(2 * i) - expected).norm(), 1e-9);
  }
}

TEST_F(WhitenedResiduals, ChangeWithRigAndMarkerAsTheirJacobiansSay) {
  const auto here = whitened_residual(o_, map_, solver_, world_from_rig_);
  ASSERT_TRUE(here);
  constexpr double kStep = 1e-6;
  for (int k = 0; k < 6; ++k) {
    const Vector6d step = kStep * Vector6d::Unit(k);
    const auto there = whitened_residual(o_, map_, solver_, world_from_rig_.plus(step));
    ASSERT_TRUE(there);
    EXPECT_LT(((there->residual - here->residual) / kStep - here->by_rig.col(k)).norm(),
              1e-4 * here->by_rig.norm());
    // The marker moved one way is the rig moved the other, where both have the same axes' origin.
    if (k < 3) {
      EXPECT_LT((here->by_rig.col(k) + here->by_marker.col(k)).norm(), 1e-6);
    }
  }
}

TEST_F(WhitenedResiduals, ThereAreNoneBehindTheCamera) {
  const Rigid3 turned = world_from_rig_ * Rigid3{so3_exp({0, M_PI, 0}), {0, 0, 0}};
  EXPECT_FALSE(whitened_residual(o_, map_, solver_, turned));
}

}  // namespace
}  // namespace waymark
