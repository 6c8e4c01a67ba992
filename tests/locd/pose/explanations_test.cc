#include "locd/pose/explanations.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/small_map.h"
#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

/// Evidence of a rig of two cameras that passes three markers, made of what truly is wrong.
class Explained : public testing::Test {
 protected:
  static MarkerMap exact_map() {
    MarkerMap map = test::small_map();
    for (MapMarker& marker : map.submaps[0].markers) marker.covariance.setZero();
    return map;
  }

  void see(const CalibrationVector& camera1, const Vector6d& marker2, int sets = 24) {
    for (int i = 0; i < sets; ++i) {
      std::vector<EvidenceRow> rows;
      const Vector6d pose = 1e-3 * Vector6d::Random();
      for (std::size_t camera = 0; camera < 2; ++camera) {
        for (std::size_t marker = 0; marker < 3; ++marker) rows.push_back(row(marker, camera));
      }
      for (EvidenceRow& r : rows) {
        ErrorColumns& c = r.columns;
        c.residual += c.by_pose * pose;
        if (r.camera == 1) c.residual += c.by_camera * camera1;
        if (r.map_index == 2) c.residual += c.by_marker * marker2;
      }
      evidence_.add(Rigid3(), rows);
    }
    evidence_.sum(1, system_);
  }

  [[nodiscard]] EvidenceRow row(std::size_t marker, std::size_t camera) {
    MarkerObservation o;
    o.size_m = 0.3;
    const Rigid3 cam_from_marker{
        so3_exp({M_PI, 0.4 * normal_(random_), 0}),
        {normal_(random_), 0.6 * normal_(random_), 5 + normal_(random_) / 2}};
    const auto x = marker_corners(o.size_m);
    const RigCamera& cam = rig_.cameras[camera];
    for (std::size_t i = 0; i < 4; ++i)
      o.corners_px[i] = *cam.model.project(cam_from_marker * x[i]);
    EvidenceRow row{marker, camera, 0,
                    *error_columns(o,
                                   {&cam.model, cam.rig_from_cam.inverse(), Rigid3{},
                                    cam.rig_from_cam * cam_from_marker},
                                   {}, Vector6d::Constant(0.3))};
    row.columns.whiten(0.01 * Matrix8d::Identity());
    for (double& number : row.columns.residual) number = normal_(random_);
    return row;
  }

  static Rig usual_rig() {
    Rig rig = test::ring_rig(2);
    for (RigCamera& camera : rig.cameras) camera.stated_sigmas = {};
    return rig;
  }

  Rig rig_ = usual_rig();
  MapIndex map_{exact_map()};
  CalibrationPrior prior_{rig_, {}, map_.submap(), false};
  Evidence evidence_{prior_};
  Evidence::System system_;
  Explanations explanations_{prior_, map_};
  std::mt19937 random_{4};
  std::normal_distribution<double> normal_;
};

TEST_F(Explained, ThatNothingIsWrongIsBestWhereNothingIs) {
  see(CalibrationVector::Zero(), Vector6d::Zero());
  for (const Score& score : explanations_.judge(system_, prior_, {})) EXPECT_LE(score.gain, 0);
}

TEST_F(Explained, AMarkerThatMovedIsFoundWithItsOffset) {
  const Vector6d moved = (Vector6d() << 0.03, 0.02, -0.01, 0, 0, 0).finished();
  see(CalibrationVector::Zero(), moved);
  const auto scores = explanations_.judge(system_, prior_, {});
  EXPECT_EQ(scores[0].what, (Explanation{AlertKind::marker_moved, -1, 2}));
  EXPECT_GT(scores[0].gain, scores[1].gain + 6);
  EXPECT_LT((scores[0].marker - moved).norm(), 0.005);
}

TEST_F(Explained, ALensIsFoundWithItsFocalLength) {
  CalibrationVector lens = CalibrationVector::Zero();
  lens[kFocal] = 0.01;
  see(lens, Vector6d::Zero());
  const auto scores = explanations_.judge(system_, prior_, {});
  EXPECT_EQ(scores[0].what, (Explanation{AlertKind::lens_off, 1, 0}));
  EXPECT_NEAR(scores[0].camera[kFocal], 0.01, 3 * scores[0].camera_sigma[kFocal] + 1e-3);
}

TEST_F(Explained, WhatIsKnownExplainsNothingASecondTime) {
  const Vector6d moved = (Vector6d() << 0.03, 0.02, -0.01, 0, 0, 0).finished();
  see(CalibrationVector::Zero(), moved);
  const Explanation known{AlertKind::marker_moved, -1, 2};
  for (const Score& score : explanations_.judge(system_, prior_, std::span(&known, 1))) {
    if (score.what != known) {
      EXPECT_LT(score.gain, 6);
    }
  }
}

}  // namespace
}  // namespace waymark
