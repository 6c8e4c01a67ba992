#include "mapbuilder/calibrate/posterior_sigmas.h"

#include <gtest/gtest.h>

#include "core/camera/kalibr.h"
#include "core/camera/rig_parameters.h"
#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

Rig bent_rig(int cameras) {
  Rig rig = test::ring_rig(cameras);
  const Rigid3 first_from_rig = rig.cameras[0].rig_from_cam.inverse();
  for (RigCamera& camera : rig.cameras) {
    CameraParameters p = camera.model.parameters();
    p.distortion = Distortion::radtan;
    p.coefficients = {-0.1, 0.02, 0, 0};
    camera.model = *CameraModel::create(p);
    camera.rig_from_cam = first_from_rig * camera.rig_from_cam;
  }
  rig.cameras[0].rig_from_cam = Rigid3{};
  return rig;
}

/// 1 mm, 1 mrad, 0.64 px of focal length, 0.5 px, 0.001 of coefficients; cam0's place is constant.
Eigen::MatrixXd joint_of(int cameras) {
  Eigen::VectorXd sigma = Eigen::VectorXd::Zero((6 + kIntrinsicNumbers) * cameras);
  for (int c = 0; c < cameras; ++c) {
    if (c > 0) sigma.segment(6 * c, 6).setConstant(0.001);
    sigma.segment(6 * cameras + kIntrinsicNumbers * c, 2).setConstant(0.64);
    sigma.segment(6 * cameras + kIntrinsicNumbers * c + 2, 2).setConstant(0.5);
    sigma.segment(6 * cameras + kIntrinsicNumbers * c + 4, 4).setConstant(0.001);
  }
  Eigen::MatrixXd joint = sigma.cwiseAbs2().asDiagonal();
  for (int c = 0; c < cameras; ++c) {
    const int fu = 6 * cameras + kIntrinsicNumbers * c;
    joint(fu, fu + 1) = joint(fu + 1, fu) = 0.999 * 0.64 * 0.64;  // fu and fv go together
  }
  return joint;
}

TEST(PosteriorSigmas, StateWhatTheAdjustmentIsSureOf) {
  const Rig rig = with_posterior_sigmas(bent_rig(2), joint_of(2), false, {});
  const StatedSigmas& second = rig.cameras[1].stated_sigmas;
  EXPECT_NEAR(second.position_m.value(), 0.001, 1e-9);
  EXPECT_NEAR(second.rotation_rad.value(), 0.001, 1e-9);
  EXPECT_NEAR(second.focal.value(), 0.001, 1e-6);
  EXPECT_NEAR(second.principal_px.value(), 0.5, 1e-9);
  EXPECT_NEAR(second.k1.value(), 0.001, 1e-9);
  EXPECT_FALSE(rig.cameras[0].stated_sigmas.position_m);
  EXPECT_EQ(rig.cameras[0].sigma_source, SigmaSource::refined);
}

TEST(PosteriorSigmas, AreReadBackWithTheRig) {
  const Rig rig = with_posterior_sigmas(bent_rig(3), joint_of(3), false, {});
  const auto read = parse_camchain(format_camchain(rig), "rig.yaml");
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_TRUE(read->rig.joint_sigmas);
  EXPECT_LT((*read->rig.joint_sigmas - *rig.joint_sigmas).norm(), 1e-9 * rig.joint_sigmas->norm());
}

TEST(PosteriorSigmas, OfNumbersThatWereConstantAreTheirDefaults) {
  Rig straight = bent_rig(1);
  CameraParameters p = straight.cameras[0].model.parameters();
  p.distortion = Distortion::none;
  straight.cameras[0].model = *CameraModel::create(p);
  const Rig rig = with_posterior_sigmas(straight, Eigen::MatrixXd::Zero(18, 18), false, {});
  EXPECT_FALSE(rig.cameras[0].stated_sigmas.focal);
  EXPECT_NEAR(std::sqrt(rig_covariance(rig)(0, 0)), 0.001, 1e-12) << "focal, as of Kalibr";
}

TEST(PosteriorSigmas, AreNoLessThanTheLimitsWhereSomethingIsHeld) {
  RefinementLimits limits;
  limits.focal = 0.01;
  const Rig rig = with_posterior_sigmas(bent_rig(1), joint_of(1), true, limits);
  EXPECT_GT(rig.cameras[0].stated_sigmas.focal.value(), 0.01);
  EXPECT_TRUE(parse_camchain(format_camchain(rig), "rig.yaml"));
}

TEST(PosteriorSigmas, TellHowFarTwoRigsAreApart) {
  const Rig one = with_posterior_sigmas(bent_rig(2), joint_of(2), false, {});
  EXPECT_EQ(squared_sigmas_apart(one, one), 0);
  Rig other = one;
  for (RigCamera& camera : other.cameras) {
    CameraParameters p = camera.model.parameters();
    p.pu_px += std::sqrt(2.0) * 0.5 * 3;  // three sigmas of the difference, one number of 7
    camera.model = *CameraModel::create(p);
  }
  EXPECT_NEAR(squared_sigmas_apart(one, other), 2 * 9.0 / 14, 1e-6);
}

TEST(PosteriorSigmas, GrowByAFactorButForWhatIsNotCalibrated) {
  const Rig one = with_posterior_sigmas(bent_rig(2), joint_of(2), false, {});
  const Rig twice = with_sigmas_times(one, 2);
  EXPECT_NEAR(*twice.cameras[1].stated_sigmas.k1, 2 * *one.cameras[1].stated_sigmas.k1, 1e-12);
  const auto parameters = rig_parameters(one);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const double ratio = (*twice.joint_sigmas)(at, at) / (*one.joint_sigmas)(at, at);
    EXPECT_NEAR(ratio,
                parameters[i].quantity == CameraQuantity::edge ||
                        parameters[i].quantity == CameraQuantity::stamp ||
                        parameters[i].quantity == CameraQuantity::readout
                    ? 1
                    : 4,
                1e-9);
  }
  EXPECT_TRUE(parse_camchain(format_camchain(twice), "rig.yaml"));
}

}  // namespace
}  // namespace waymark
