#include "simulator/capture_plan.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/capture/frame_set.h"
#include "simulator/scene_library.h"

namespace waymark::simulator {
namespace {

class PlanOfRoom1 : public testing::Test {
 protected:
  [[nodiscard]] CapturePlan plan(bool moving, double skew_sigma_s, int positions = 300) const {
    return {*scene_, *rig_, positions, moving, skew_sigma_s, 5};
  }

  Expected<Scene> scene_ = load_scene("room1");
  Expected<SimulatedRig> rig_ = load_rig("cg120");
};

TEST_F(PlanOfRoom1, WithoutSkewCamerasExposeTogether) {
  const CapturePlan together = plan(true, 0);
  for (std::size_t i = 0; i < together.exposures().size(); ++i) {
    EXPECT_EQ(together.exposures()[i].stamp, together.exposures()[i - i % 3].stamp);
  }
}

TEST_F(PlanOfRoom1, SkewIsOfTheStatedSigmaAndBounded) {
  constexpr double kSigma_s = 0.0007;
  const CapturePlan skewed = plan(true, kSigma_s);
  const CapturePlan together = plan(true, 0);
  double squares = 0;
  for (std::size_t i = 0; i < skewed.exposures().size(); ++i) {
    const double skew_s =
        std::chrono::duration<double>(skewed.exposures()[i].stamp - together.exposures()[i].stamp)
            .count();
    EXPECT_LE(std::abs(skew_s), 3 * kSigma_s + 1e-9);
    EXPECT_LT(2 * std::abs(skew_s), std::chrono::duration<double>(kDefaultSyncTolerance).count());
    squares += skew_s * skew_s;
  }
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(skewed.exposures().size())), kSigma_s,
              0.05 * kSigma_s);
}

TEST_F(PlanOfRoom1, AMovingRigIsWhereItIsAtTheStampItTells) {
  const CapturePlan skewed = plan(true, 0.002);
  const Trajectory way(scene_->trajectory);
  const Stamp start = plan(true, 0).exposures().front().stamp;
  for (const Exposure& exposure : skewed.exposures()) {
    const double time_s = std::chrono::duration<double>(exposure.stamp - start).count();
    const Rigid3 world_from_cam0 = way.world_from_cam0(time_s * scene_->trajectory.speed_mps);
    const Rigid3 world_from_cam = world_from_cam0 * rig_->rig.cameras[0].rig_from_cam.inverse() *
                                  rig_->rig.cameras[exposure.camera].rig_from_cam;
    EXPECT_LT(skewed.world_from_cam(exposure).minus(world_from_cam).norm(), 1e-9);
    EXPECT_LT(skewed.motion(exposure)(0).minus(world_from_cam).norm(), 1e-9);
  }
}

TEST_F(PlanOfRoom1, AStandingRigDoesNotCareForSkew) {
  const CapturePlan skewed = plan(false, 0.002);
  const CapturePlan together = plan(false, 0);
  for (std::size_t i = 0; i < skewed.exposures().size(); ++i) {
    EXPECT_EQ(skewed.world_from_rig(skewed.exposures()[i]).translation,
              together.world_from_rig(together.exposures()[i]).translation);
  }
}

}  // namespace
}  // namespace waymark::simulator
