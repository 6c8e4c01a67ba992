#include "core/geometry/alignment.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace waymark {
namespace {

class Alignment : public ::testing::Test {
 protected:
  Eigen::Vector3d random_vector() { return {normal_(random_), normal_(random_), normal_(random_)}; }

  std::vector<Eigen::Vector3d> random_points(std::size_t count) {
    std::vector<Eigen::Vector3d> points(count);
    for (auto& x : points) x = 4 * random_vector();
    return points;
  }

  static std::vector<Eigen::Vector3d> moved(const std::vector<Eigen::Vector3d>& points,
                                            const Similarity3& motion) {
    std::vector<Eigen::Vector3d> result;
    for (const auto& x : points) result.push_back(motion * x);
    return result;
  }

  std::mt19937 random_{7};
  std::normal_distribution<double> normal_;
  const Rigid3 motion_{so3_exp({0.3, -2.1, 0.7}), {10, -20, 30}};
};

TEST_F(Alignment, RecoversAMotionExactly) {
  const auto source = random_points(10);
  const auto found = align_points(source, moved(source, {1, motion_}), false);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->scale, 1);
  EXPECT_LT((found->motion.translation - motion_.translation).norm(), 1e-12);
  EXPECT_LT(angle_between_rad(found->motion.rotation, motion_.rotation), 1e-13);
}

TEST_F(Alignment, RecoversTheScaleWhenItIsFree) {
  const auto source = random_points(10);
  const auto target = moved(source, {1.25, motion_});
  const auto found = align_points(source, target, true);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->scale, 1.25, 1e-13);
  EXPECT_LT((found->motion.translation - motion_.translation).norm(), 1e-12);
  EXPECT_EQ(align_points(source, target, false)->scale, 1);
}

TEST_F(Alignment, IsTheLeastSquaresMotionUnderNoise) {
  const auto source = random_points(50);
  auto target = moved(source, {1, motion_});
  for (auto& x : target) x += 0.1 * random_vector();
  const auto found = align_points(source, target, false);
  ASSERT_TRUE(found);
  const auto cost = [&](const Rigid3& motion) {
    double sum = 0;
    for (std::size_t i = 0; i < source.size(); ++i) {
      sum += (target[i] - motion * source[i]).squaredNorm();
    }
    return sum;
  };
  const double best = cost(found->motion);
  EXPECT_LT(best, cost(motion_));
  for (int axis = 0; axis < 6; ++axis) {
    for (const double step : {-1e-4, 1e-4}) {
      EXPECT_GT(cost(found->motion.plus(step * Vector6d::Unit(axis))), best);
    }
  }
}

TEST_F(Alignment, NeverReflects) {
  const auto source = random_points(10);
  auto target = source;
  for (auto& x : target) x.z() = -x.z();
  const auto found = align_points(source, target, false);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->motion.rotation.toRotationMatrix().determinant(), 1, 1e-12);
}

TEST_F(Alignment, PointsOnAPlaneAreEnough) {
  auto source = random_points(10);
  for (auto& x : source) x.z() = 0;
  const auto found = align_points(source, moved(source, {1, motion_}), false);
  ASSERT_TRUE(found);
  EXPECT_LT(angle_between_rad(found->motion.rotation, motion_.rotation), 1e-12);
}

TEST_F(Alignment, PointsOnALineAreRefused) {
  std::vector<Eigen::Vector3d> line;
  for (int i = 0; i < 10; ++i)
    line.push_back(Eigen::Vector3d(1, 2, 3) * i + Eigen::Vector3d(5, 0, 1));
  EXPECT_TRUE(lie_on_a_line(line));
  EXPECT_FALSE(align_points(line, moved(line, {1, motion_}), false));
  EXPECT_FALSE(align_points(random_points(10), line, false));
  // 18 m long; 1e-6 of it is the threshold.
  line[4] += 1e-7 * Eigen::Vector3d::UnitZ();
  EXPECT_TRUE(lie_on_a_line(line));
  line[4] += 1e-3 * Eigen::Vector3d::UnitZ();
  EXPECT_FALSE(lie_on_a_line(line));
}

TEST_F(Alignment, TooFewPointsAreRefused) {
  for (const std::size_t count : {0, 1, 2}) {
    const auto points = random_points(count);
    EXPECT_TRUE(lie_on_a_line(points));
    EXPECT_FALSE(align_points(points, points, false));
  }
  EXPECT_FALSE(align_poses({}, {}, false));
}

TEST_F(Alignment, CoincidentPointsLieOnALine) {
  const std::vector<Eigen::Vector3d> same(5, Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(lie_on_a_line(same));
}

TEST_F(Alignment, PosesAlignEvenOnALine) {
  std::vector<Rigid3> source;
  std::vector<Rigid3> target;
  for (int i = 0; i < 8; ++i) {
    source.push_back({so3_exp(random_vector()), Eigen::Vector3d(i, 0, 0)});
    target.push_back(motion_ * source.back());
    target.back().translation =
        motion_.rotation * (1.5 * source.back().translation) + motion_.translation;
  }
  const auto found = align_poses(source, target, true);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->scale, 1.5, 1e-12);
  EXPECT_LT((found->motion.translation - motion_.translation).norm(), 1e-12);
  EXPECT_LT(angle_between_rad(found->motion.rotation, motion_.rotation), 1e-12);
}

TEST_F(Alignment, OnePoseDeterminesAllButTheScale) {
  const std::vector<Rigid3> source{{so3_exp({1, 1, 1}), {1, 2, 3}}};
  const std::vector<Rigid3> target{motion_ * source[0]};
  const auto found = align_poses(source, target, true);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->scale, 1);
  EXPECT_LT((found->motion.translation - motion_.translation).norm(), 1e-12);
}

TEST_F(Alignment, PoseRotationsAreAveragedWhateverTheirSign) {
  const std::vector<Rigid3> source(2);
  std::vector<Rigid3> target(2);
  target[0].rotation = so3_exp({0, 0, -0.1});
  target[1].rotation = so3_exp({0, 0, 0.1});
  target[1].rotation.coeffs() *= -1;
  const auto found = align_poses(source, target, false);
  ASSERT_TRUE(found);
  EXPECT_LT(so3_log(found->motion.rotation).norm(), 1e-14);
}

}  // namespace
}  // namespace waymark
