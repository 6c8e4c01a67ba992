#include "mapbuilder/diagnosis/baseline_scale.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/mapbuilder/diagnosis/seen_rooms.h"

namespace waymark {
namespace {

using testing::HasSubstr;

/// What a fit knows: half a millimetre and a hundredth of a degree.
Eigen::MatrixXd covariance_of(const Rig& rig) {
  const auto size = static_cast<Eigen::Index>(6 * rig.cameras.size());
  Eigen::VectorXd variance(size);
  for (Eigen::Index i = 0; i < size; ++i) variance[i] = i % 6 < 3 ? 2.5e-7 : 3e-8;
  variance.head<6>().setZero();
  return variance.asDiagonal();
}

/// The rig with each camera off by so much (m; a twentieth of it in rad), any way.
Rig shaken(Rig rig, double by_m, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (std::size_t k = 1; k < rig.cameras.size(); ++k) {
    Vector6d off;
    for (int i = 0; i < 6; ++i) off[i] = normal(random) * (i < 3 ? by_m : 0.05 * by_m);
    rig.cameras[k].rig_from_cam = rig.cameras[k].rig_from_cam.plus(off);
  }
  return rig;
}

TEST(BaselineScale, OneFactorOnAllBaselinesIsToldWithItsSide) {
  for (const test::RigKind& kind : test::kRigKinds) {
    if (kind.cameras < 2) continue;
    const Rig stated = test::rig_of(kind);
    for (const double factor : {0.8, 0.95, 1.06, 1.25}) {
      for (const unsigned seed : {1U, 2U}) {
        SCOPED_TRACE(testing::Message() << kind.name << " x " << factor << ", seed " << seed);
        const Rig fitted = shaken(with_baselines(stated, factor), 0.0005, seed);
        const auto scale = baseline_scale(stated, fitted, covariance_of(stated));
        ASSERT_TRUE(scale);
        EXPECT_NEAR(scale->factor, factor, 4 * scale->sigma);
        const Finding finding = finding_of(*scale, stated);
        EXPECT_EQ(finding.cause, Cause::size_scale);
        EXPECT_THAT(finding.text,
                    HasSubstr(factor < 1 ? "too small against" : "too large against"));
        EXPECT_EQ(finding.severity,
                  std::abs(scale->factor - 1) > 0.05 ? Severity::error : Severity::warning);
      }
    }
  }
}

TEST(BaselineScale, SoundAndDisplacedCamerasAreNoScale) {
  for (const test::RigKind& kind : test::kRigKinds) {
    if (kind.cameras < 2) continue;
    const Rig stated = test::rig_of(kind);
    for (unsigned seed = 1; seed <= 20; ++seed) {
      SCOPED_TRACE(testing::Message() << kind.name << ", seed " << seed);
      EXPECT_FALSE(baseline_scale(stated, shaken(stated, 0.0008, seed), covariance_of(stated)));
    }
    Rig displaced = stated;
    displaced.cameras.back().rig_from_cam.translation += Eigen::Vector3d(0, 0, 0.02);
    displaced.cameras.back().rig_from_cam.rotation =
        displaced.cameras.back().rig_from_cam.rotation * so3_exp({0.02, 0, 0});
    EXPECT_FALSE(baseline_scale(stated, displaced, covariance_of(stated)));
  }
}

// Of several cameras: of two, one that stands elsewhere along its baseline is the same.
TEST(BaselineScale, LittleOfItComesBeforeSeveralCamerasAndNoCameraPassesForIt) {
  constexpr double kGainOverCameras = 4;
  for (const test::RigKind& kind : test::kRigKinds) {
    if (kind.cameras < 3) continue;
    const Rig stated = test::rig_of(kind);
    const Eigen::MatrixXd covariance = 0.04 * covariance_of(stated);
    for (const double factor : {0.97, 1.03}) {
      SCOPED_TRACE(testing::Message() << kind.name << " x " << factor);
      const Rig fitted = shaken(with_baselines(stated, factor), 0.0001, 1);
      const auto scale = baseline_scale(stated, fitted, covariance, kGainOverCameras);
      ASSERT_TRUE(scale);
      EXPECT_NEAR(scale->factor, factor, 4 * scale->sigma);
    }
    Rig displaced = stated;
    Eigen::Vector3d& at = displaced.cameras[1].rig_from_cam.translation;
    at += 0.004 * (at - stated.cameras[0].rig_from_cam.translation).normalized();
    EXPECT_FALSE(baseline_scale(stated, displaced, covariance, kGainOverCameras)) << kind.name;
  }
}

TEST(BaselineScale, FactorsThatAreUnitsAreToldAsSuch) {
  EXPECT_THAT(sizes_against_baselines({1000.6, 1}), HasSubstr("1001 times too large"));
  EXPECT_THAT(sizes_against_baselines({1000.6, 1}), HasSubstr("sizes in mm"));
  EXPECT_THAT(sizes_against_baselines({0.0101, 1e-5}), HasSubstr("baselines in cm"));
  EXPECT_THAT(sizes_against_baselines({1.2, 0.01}), HasSubstr("20.0 ± 1.0 % too large"));
}

TEST(BaselineScale, NothingKnownTellsNothing) {
  const Rig rig = test::rig_of(test::kRigKinds[0]);
  EXPECT_FALSE(baseline_scale(rig, with_baselines(rig, 1.2), Eigen::MatrixXd()));
}

}  // namespace
}  // namespace waymark
