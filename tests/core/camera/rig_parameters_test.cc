#include "core/camera/rig_parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/check.h"

namespace waymark {
namespace {

using testing::HasSubstr;

CameraModel model(Distortion distortion) {
  CameraParameters p;
  p.width_px = 640;
  p.height_px = 480;
  p.fu_px = p.fv_px = 500;
  p.pu_px = 320;
  p.pv_px = 240;
  p.distortion = distortion;
  const auto made = CameraModel::create(p);
  WAYMARK_CHECK(made);
  return *made;
}

/// cam0 is the rig's frame; cam1 has a global shutter and no distortion.
Rig two_cameras() {
  Rig rig;
  rig.cameras.push_back({"cam0", model(Distortion::radtan), {}, "", "", 15000.0, {}, {}});
  Rigid3 place;
  place.translation.x() = 0.1;
  rig.cameras.push_back({"cam1", model(Distortion::none), place, "", "", {}, true, {}});
  return rig;
}

std::size_t count_of(const std::vector<RigParameter>& all, std::size_t camera) {
  return static_cast<std::size_t>(
      std::count_if(all.begin(), all.end(), [&](const auto& p) { return p.camera == camera; }));
}

TEST(RigParameters, OnlyWhatTheModelHas) {
  const auto parameters = rig_parameters(two_cameras());
  // cam0: f, pu, pv, k1, edge, stamp, read-out. cam1: six of its place, f, pu, pv, edge, stamp.
  EXPECT_EQ(count_of(parameters, 0), 7U);
  EXPECT_EQ(count_of(parameters, 1), 11U);
  EXPECT_EQ(parameters.front(), (RigParameter{0, CameraQuantity::focal, 0}));
  EXPECT_EQ(parameters[7], (RigParameter{1, CameraQuantity::position, 0}));
  EXPECT_EQ(parameters.back(), (RigParameter{1, CameraQuantity::stamp, 0}));
}

TEST(RigParameters, StatedSigmasBeatDefaults) {
  Rig rig = two_cameras();
  rig.cameras[1].stated_sigmas.focal = 0.02;
  EXPECT_EQ(sigmas_of(rig.cameras[1]).focal, 0.02);
  EXPECT_EQ(sigmas_of(rig.cameras[1]).principal_px, 0.5);
  EXPECT_EQ(sigmas_of(rig.cameras[1]).k1, 0) << "a lens without distortion has none";
  EXPECT_EQ(sigmas_of(rig.cameras[1]).readout_s, 0) << "a global shutter";
  EXPECT_DOUBLE_EQ(sigmas_of(rig.cameras[0]).readout_s, 0.02 * 0.015);
  EXPECT_EQ(sigmas_of(rig.cameras[0]).position_m, 0) << "the rig's frame";
}

TEST(RigParameters, HalfOfTheEdgesVarianceIsCommon) {
  const Rig rig = two_cameras();
  const auto parameters = rig_parameters(rig);
  const Eigen::MatrixXd covariance = rig_covariance(rig);
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    const RigParameter& a = parameters[static_cast<std::size_t>(i)];
    const double sigma = sigma_of(a, sigmas_of(rig.cameras[a.camera]));
    EXPECT_DOUBLE_EQ(covariance(i, i), sigma * sigma);
    for (Eigen::Index j = 0; j < i; ++j) {
      const RigParameter& b = parameters[static_cast<std::size_t>(j)];
      const bool edges = a.quantity == CameraQuantity::edge && b.quantity == CameraQuantity::edge;
      EXPECT_DOUBLE_EQ(covariance(i, j), edges ? 0.5 * 0.04 : 0.0);
    }
  }
}

TEST(RigParameters, ACameraAloneHasItsOwnNumbers) {
  Rig rig = two_cameras();
  const auto all = rig_parameters(rig);
  const auto size = static_cast<Eigen::Index>(all.size());
  rig.joint_sigmas = Eigen::MatrixXd::Identity(size, size);
  for (Eigen::Index i = 0; i < size; ++i) (*rig.joint_sigmas)(i, i) = 1.0 + static_cast<double>(i);
  const Rig alone = single_camera_rig(rig, 1);
  ASSERT_EQ(alone.cameras.size(), 1U);
  EXPECT_TRUE(is_rig_frame(alone.cameras[0]));
  const Eigen::MatrixXd covariance = rig_covariance(alone);
  ASSERT_EQ(covariance.rows(), static_cast<Eigen::Index>(rig_parameters(alone).size()));
  EXPECT_EQ(covariance(0, 0), 14) << "the focal length stands behind six of cam1's place";
}

// Rig files whose sigmas contradict each other are refused (kalibr_sigmas.h).
TEST(RigParameters, WhatIsStatedAnewIsInTheJointSigmasToo) {
  for (const CameraQuantity quantity : {CameraQuantity::edge, CameraQuantity::position,
                                        CameraQuantity::principal, CameraQuantity::stamp}) {
    Rig rig = two_cameras();
    const auto all = rig_parameters(rig);
    const auto size = static_cast<Eigen::Index>(all.size());
    const Eigen::MatrixXd before =
        Eigen::MatrixXd::Identity(size, size) + Eigen::MatrixXd::Constant(size, size, 0.5);
    rig.joint_sigmas = before;
    state_sigma(1, quantity, 0.005, rig);
    EXPECT_EQ(sigma_of({1, quantity, 0}, sigmas_of(rig.cameras[1])), 0.005);
    const Eigen::MatrixXd after = rig_covariance(rig);
    for (Eigen::Index i = 0; i < size; ++i) {
      for (Eigen::Index j = 0; j < size; ++j) {
        const auto anew = [&](Eigen::Index k) {
          const RigParameter& one = all[static_cast<std::size_t>(k)];
          return one.camera == 1 && one.quantity == quantity;
        };
        const double expected = i == j ? 0.005 * 0.005 : 0;
        EXPECT_EQ(after(i, j), anew(i) || anew(j) ? expected : before(i, j));
      }
    }
  }
}

TEST(RigParameters, JointSigmasOfOtherNumbersAreDropped) {
  Rig rig = two_cameras();
  const auto size = static_cast<Eigen::Index>(rig_parameters(rig).size());
  rig.joint_sigmas = Eigen::MatrixXd::Identity(size, size);
  drop_unfit_joint_sigmas(rig);
  EXPECT_TRUE(rig.joint_sigmas);
  rig.joint_sigmas = Eigen::MatrixXd::Identity(size - 1, size - 1);
  drop_unfit_joint_sigmas(rig);
  EXPECT_FALSE(rig.joint_sigmas);
}

TEST(RigParameters, AnExactRigIsOne) {
  const Rig rig = stated_exact(two_cameras());
  EXPECT_LT(rig_covariance(rig).cwiseAbs().maxCoeff(), 1e-17);
  EXPECT_FALSE(rig.cameras[1].stated_sigmas.k1) << "what the model lacks is not stated";
}

TEST(RigParameters, ARigWithoutSigmasSaysWhichAreTaken) {
  Rig rig = two_cameras();
  const auto note = note_of_default_sigmas(rig, "rig.yaml");
  ASSERT_TRUE(note);
  EXPECT_THAT(*note, HasSubstr("rig.yaml: states no sigma"));
  EXPECT_THAT(*note, HasSubstr("1 mm and 0.05°"));
  rig.cameras[1].stated_sigmas.edge_px = 0.1;
  EXPECT_FALSE(note_of_default_sigmas(rig, "rig.yaml"));
}

}  // namespace
}  // namespace waymark
