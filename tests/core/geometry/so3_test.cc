#include "core/geometry/so3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace waymark {
namespace {

Eigen::Vector3d random_vector(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return {normal(random), normal(random), normal(random)};
}

TEST(So3, SkewIsTheCrossProduct) {
  const Eigen::Vector3d a(1, -2, 3);
  const Eigen::Vector3d b(0.5, 4, -1);
  EXPECT_TRUE((skew(a) * b).isApprox(a.cross(b), 1e-15));
}

TEST(So3, ExpIsTheRotationAboutTheAxis) {
  const Eigen::Quaterniond quarter = so3_exp({0, 0, std::numbers::pi / 2});
  EXPECT_TRUE((quarter * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-15));
}

TEST(So3, LogUndoesExpAtEverySize) {
  std::mt19937 random(1);
  for (const double angle : {0.0, 1e-12, 1e-8, 1e-5, 0.99e-4, 1.01e-4, 0.1, 1.0, 3.0, 3.14159}) {
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector3d vector = random_vector(random).normalized() * angle;
      const Eigen::Quaterniond q = so3_exp(vector);
      EXPECT_NEAR(q.norm(), 1, 1e-14);
      EXPECT_LT((so3_log(q) - vector).norm(), 1e-15 + 1e-14 * angle) << angle;
    }
  }
}

TEST(So3, BothSignsOfAQuaternionAreOneRotation) {
  const Eigen::Quaterniond q = so3_exp({0.3, -2, 1});
  const Eigen::Quaterniond opposite(-q.w(), -q.x(), -q.y(), -q.z());
  EXPECT_TRUE(so3_log(q).isApprox(so3_log(opposite), 1e-15));
  EXPECT_LT(angle_between_rad(q, opposite), 1e-15);
}

TEST(So3, AngleIsGeodesicUpToPi) {
  const Eigen::Quaterniond a = so3_exp({0.1, 0.2, 0.3});
  for (const double angle : {1e-9, 0.5, 3.0, std::numbers::pi}) {
    const Eigen::Quaterniond b = a * so3_exp(Eigen::Vector3d(0.6, 0, 0.8) * angle);
    EXPECT_NEAR(angle_between_rad(a, b), angle, 1e-14);
  }
  const Eigen::Quaterniond beyond = so3_exp({std::numbers::pi + 0.1, 0, 0});
  EXPECT_NEAR(so3_log(beyond).norm(), std::numbers::pi - 0.1, 1e-14);
}

}  // namespace
}  // namespace waymark
