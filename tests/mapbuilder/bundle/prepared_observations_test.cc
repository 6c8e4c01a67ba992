#include "mapbuilder/bundle/prepared_observations.h"

#include "core/marker/marker_outline.h"
#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark {
namespace {

void expect_alike(const PreparedObservations& a, const PreparedObservations& b) {
  for (const ObservationIndex index : a.selection().used()) {
    EXPECT_EQ(a[index].corners_px, b[index].corners_px);
    EXPECT_EQ(a[index].size_m, b[index].size_m);
    EXPECT_EQ(a[index].whitening, b[index].whitening);
    ASSERT_EQ(a[index].ippe.has_value(), b[index].ippe.has_value());
    if (!a[index].ippe) continue;
    EXPECT_EQ(a[index].ippe->cam_from_marker[0].translation,
              b[index].ippe->cam_from_marker[0].translation);
  }
}

class Prepared : public testing::Test {
 protected:
  Prepared() : room(test::make_room({})), start(room) {}

  /// Another estimate: sizes, edges, a camera and noise.
  [[nodiscard]] Estimate changed() const {
    Estimate estimate = start.truth;
    for (double& size_m : estimate.calibration.sizes_m) size_m *= 1.01;
    estimate.calibration.edge_bias_steps_px[CameraIndex(1)] = {0.3, -0.1};
    Vector6d off;
    off << 0.01, 0, 0, 0, 0.002, 0;
    RigCamera& camera = estimate.calibration.rigs.front().cameras[2];
    camera.rig_from_cam = camera.rig_from_cam.plus(off);
    estimate.components.front().noise.model_sigma_px = 0.4;
    return estimate;
  }

  test::SyntheticRoom room;
  test::PreparedRoom start;
};

TEST_F(Prepared, UpdatedIsWhatAnEstimateSaysWhateverWasBefore) {
  PreparedObservations updated = start.prepared;
  updated.update(changed());
  expect_alike(updated, PreparedObservations(start.selection, changed(), 3));
  updated.update(start.truth);
  expect_alike(updated, start.prepared);
}

TEST_F(Prepared, EdgesMoveInStepByStep) {
  const Estimate estimate = changed();
  const PreparedObservations prepared(start.selection, estimate, 1);
  bool checked = false;
  for (const ObservationIndex index : start.selection.used()) {
    const Observation& o = start.observations[index];
    if (o.camera != CameraIndex(1)) {
      EXPECT_EQ(prepared[index].corners_px, o.corners_px);
      continue;
    }
    const auto outward = outward_of(o.corners_px);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_LT((prepared[index].corners_px[i] - (o.corners_px[i] - 0.2 * outward[i])).norm(),
                1e-9);
    }
    checked = true;
  }
  EXPECT_TRUE(checked);
  EXPECT_NEAR(estimate.calibration.edge_bias_px(CameraIndex(1)), 0.2, 1e-12);
}

TEST_F(Prepared, WhatNeedsNoSolutionsGetsNoneOfAnEarlierCalibration) {
  PreparedObservations updated = start.prepared;
  updated.update(changed(), PreparedObservations::Ippe::none);
  EXPECT_FALSE(updated[ObservationIndex(0)].ippe);
  updated.update(changed());
  expect_alike(updated, PreparedObservations(start.selection, changed(), 1));
}

}  // namespace
}  // namespace waymark
