#include "mapbuilder/diagnosis/camera_displacement.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

#include "core/geometry/decompositions.h"
#include "core/geometry/degrees.h"
#include "tests/mapbuilder/diagnosis/seen_rooms.h"

namespace waymark {
namespace {

/// What a fit knows of all cameras but the first: half a millimetre and a hundredth of a degree.
Eigen::MatrixXd covariance_of(const Rig& rig) {
  const auto size = static_cast<Eigen::Index>(6 * rig.cameras.size());
  Eigen::VectorXd variance(size);
  for (Eigen::Index i = 0; i < size; ++i) variance[i] = i % 6 < 3 ? 2.5e-7 : 3e-8;
  variance.head<6>().setZero();
  return variance.asDiagonal();
}

std::vector<std::size_t> named(const Rig& stated, const Rig& fitted) {
  const Eigen::MatrixXd covariance = covariance_of(stated);
  const auto all = camera_displacements(stated, fitted, covariance,
                                        least_displacing_reference(stated, fitted, covariance));
  std::vector<std::size_t> cameras;
  for (std::size_t c = 0; c < all.size(); ++c) {
    if (all[c].is_worth_naming()) cameras.push_back(c);
  }
  return cameras;
}

/// The rig as images tell it when one camera stands elsewhere: the first one is where it is said to
/// be, whoever moved.
Rig fitted_to(const Rig& stated, std::size_t moved, const Rigid3& by) {
  Rig real = stated;
  real.cameras[moved].rig_from_cam = real.cameras[moved].rig_from_cam * by;
  const Rigid3 gauge = stated.cameras[0].rig_from_cam * real.cameras[0].rig_from_cam.inverse();
  for (RigCamera& camera : real.cameras) camera.rig_from_cam = gauge * camera.rig_from_cam;
  return real;
}

TEST(CameraDisplacement, TheOneThatMovedIsNamedWhicheverItIs) {
  const Rigid3 turned{so3_exp({0.02, -0.03, 0.01}), {0, 0, 0}};
  const Rigid3 shifted{so3_exp({0, 0, 0}), {0.01, 0.02, -0.01}};
  for (const test::RigKind& kind : test::kRigKinds) {
    const Rig stated = test::rig_of(kind);
    EXPECT_TRUE(named(stated, stated).empty());
    if (kind.cameras < 3) continue;
    for (const Rigid3& by : {turned, shifted, turned * shifted}) {
      for (std::size_t moved = 0; moved < stated.cameras.size(); ++moved) {
        EXPECT_EQ(named(stated, fitted_to(stated, moved, by)), std::vector{moved}) << kind.name;
      }
    }
  }
}

TEST(CameraDisplacement, OfTwoTheFirstStaysWhereItIsSaidToBe) {
  const Rig stated = test::rig_of(test::kRigKinds[3]);
  const Rigid3 turned{so3_exp({0.02, -0.03, 0.01}), {0, 0, 0}};
  for (const std::size_t moved : {0U, 1U}) {
    EXPECT_EQ(named(stated, fitted_to(stated, moved, turned)), std::vector<std::size_t>{1});
  }
}

TEST(CameraDisplacement, WhatAnyRigFileLeavesIsNotNamedNorWhatIsHardlyKnown) {
  const Rig stated = test::rig_of(test::kRigKinds[0]);
  const auto shifted = [](double by_m) { return Rigid3{so3_exp({0, 0, 0}), {by_m, 0, 0}}; };
  const auto turned = [](double by_deg) {
    return Rigid3{so3_exp({0, by_deg / kDegreesPerRadian, 0}), {0, 0, 0}};
  };
  EXPECT_TRUE(named(stated, fitted_to(stated, 2, turned(0.09))).empty());
  EXPECT_FALSE(named(stated, fitted_to(stated, 2, turned(0.11))).empty());
  // Five sigmas are 2.5 mm here.
  EXPECT_TRUE(named(stated, fitted_to(stated, 2, shifted(0.0024))).empty());
  EXPECT_FALSE(named(stated, fitted_to(stated, 2, shifted(0.0026))).empty());
}

TEST(CameraDisplacement, SigmasAreThoseOfDraws) {
  const Rig stated = test::rig_of(test::kRigKinds[0]);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd root(18, 18);
  for (Eigen::Index i = 0; i < root.size(); ++i) root.data()[i] = 1e-3 * normal(random);
  root.topRows<6>().setZero();
  const Eigen::MatrixXd covariance = root * root.transpose();
  constexpr int kDraws = 4000;
  Eigen::Matrix3d moved = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d turned = Eigen::Matrix3d::Zero();
  const auto seen = [](const Rig& rig) {
    return rig.cameras[1].rig_from_cam.inverse() * rig.cameras[2].rig_from_cam;
  };
  const Rigid3 expected = seen(stated);
  for (int i = 0; i < kDraws; ++i) {
    Eigen::VectorXd by(18);
    for (Eigen::Index k = 0; k < 18; ++k) by[k] = normal(random);
    by = root * by;
    Rig drawn = stated;
    for (std::size_t c = 0; c < 3; ++c) {
      Rigid3& place = drawn.cameras[c].rig_from_cam;
      place = place.plus(by.segment<6>(static_cast<Eigen::Index>(6 * c)));
    }
    const Vector6d off = seen(drawn).minus(expected);
    moved += off.head<3>() * off.head<3>().transpose() / kDraws;
    turned += off.tail<3>() * off.tail<3>().transpose() / kDraws;
  }
  const CameraDisplacement sure = camera_displacements(stated, stated, covariance, 1)[2];
  EXPECT_NEAR(sure.moved_sigma_m, std::sqrt(symmetric_eigenvalues<3>(moved)[2]),
              0.05 * sure.moved_sigma_m);
  EXPECT_NEAR(sure.turned_sigma_rad, std::sqrt(symmetric_eigenvalues<3>(turned)[2]),
              0.05 * sure.turned_sigma_rad);
}

}  // namespace
}  // namespace waymark
