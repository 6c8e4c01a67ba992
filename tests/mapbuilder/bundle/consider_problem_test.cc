#include "mapbuilder/bundle/consider_problem.h"

#include <gtest/gtest.h>

#include "tests/mapbuilder/bundle/bundle_of_room.h"
#include "tests/mapbuilder/bundle/dense_blocks.h"

namespace waymark {
namespace {

test::RoomOptions small_room() {
  test::RoomOptions options;
  options.markers = 8;
  options.frame_sets = 12;
  options.room_m = 5;
  return options;
}

class ConsideredProblem : public testing::Test {
 protected:
  [[nodiscard]] BundleProblem free_problem() const {
    BundleProblem problem = test::bundle_of(room);
    problem.constant = {};
    return problem;
  }
  test::PreparedRoom room{test::make_room(small_room())};
};

TEST_F(ConsideredProblem, TwoHalvesAreTheWhole) {
  ConsiderProblem problem(free_problem(), room.truth, 1);
  const ConsiderEquations all = problem.equations();
  const ConsiderEquations even = problem.equations(FrameSetHalf::even);
  const ConsiderEquations odd = problem.equations(FrameSetHalf::odd);
  EXPECT_TRUE((even.mixed + odd.mixed).isApprox(all.mixed, 1e-9));
  const auto information = [](const ConsiderEquations& e) {
    return test::dense(e.markers.information);
  };
  EXPECT_TRUE((information(even) + information(odd)).isApprox(information(all), 1e-9));
  EXPECT_GT((information(even) - information(odd)).norm(), 0.01 * information(all).norm());
}

TEST_F(ConsideredProblem, NothingWasEstimatedUnlessTheScopeSaysSo) {
  const ConsiderProblem stated(free_problem(), room.truth, 1);
  EXPECT_EQ(stated.columns(), stated.parameters().count());
  for (const char one : stated.estimated()) EXPECT_EQ(one, 0);

  BundleProblem refined = free_problem();
  refined.scope.variable.intrinsics = true;
  const ConsiderProblem problem(refined, room.truth, 1);
  // Of each lens beside its parameters: the ratio of focal lengths and three coefficients.
  EXPECT_EQ(problem.columns(), problem.parameters().count() + 3 * 4);
  for (Eigen::Index i = 0; i < problem.parameters().count(); ++i) {
    const CameraQuantity quantity =
        problem.parameters().all[static_cast<std::size_t>(i)].of_rig.quantity;
    const bool of_lens = quantity == CameraQuantity::focal || quantity == CameraQuantity::principal;
    if (problem.parameters().all[static_cast<std::size_t>(i)].is_size()) continue;
    EXPECT_EQ(problem.estimated()[static_cast<std::size_t>(i)] != 0, of_lens);
  }
}

// A calibration that states all of its errors together knew nothing of the images' edges.
TEST(ConsiderProblem, MeasuredEdgesAreAsSureAsImagesTellWhateverTheRigStates) {
  for (const bool jointly : {false, true}) {
    test::SyntheticRoom made = test::make_room(small_room());
    for (RigCamera& camera : made.rig.cameras) camera.stated_sigmas.edge_px = 0.2;
    if (jointly) made.rig.joint_sigmas = rig_covariance(made.rig);
    const test::PreparedRoom room(made, [](Observations& observations) {
      for (auto& edges : observations.edges) edges = EdgeMeasurement{0.354, 0.005, {}};
    });
    BundleProblem of_room = test::bundle_of(room);
    of_room.constant = {};
    const ConsiderProblem problem(of_room, room.truth, 1);
    int edges = 0;
    for (Eigen::Index i = 0; i < problem.parameters().count(); ++i) {
      const ConsiderParameter& one = problem.parameters().all[static_cast<std::size_t>(i)];
      if (one.is_size() || one.of_rig.quantity != CameraQuantity::edge) continue;
      ++edges;
      EXPECT_NEAR(std::sqrt(problem.parameters().covariance(i, i)), 0.005, 1e-12) << jointly;
    }
    EXPECT_EQ(edges, 3);
  }
}

TEST(ConsiderProblem, ASizeMovesWhatItsFactorMoves) {
  // Markers and sizes grown together leave one camera's images as they are: N d + M e = 0.
  test::RoomOptions options = small_room();
  options.cameras = 1;
  const test::PreparedRoom room(test::make_room(options));
  BundleProblem of_room = test::bundle_of(room);
  of_room.constant = {};
  ConsiderProblem problem(of_room, room.truth, 1);
  const ConsiderEquations all = problem.equations();
  Eigen::VectorXd grown = Eigen::VectorXd::Zero(all.mixed.rows());
  const auto& poses = all.markers.world_from_marker;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    grown.segment<3>(static_cast<Eigen::Index>(6 * i)) = poses[i].translation;
  }
  const Eigen::Index size = problem.parameters().count() - 1;
  ASSERT_TRUE(problem.parameters().all[static_cast<std::size_t>(size)].is_size());
  const Eigen::VectorXd left = test::dense(all.markers.information) * grown + all.mixed.col(size);
  EXPECT_LT(left.norm(), 1e-6 * all.mixed.col(size).norm());
}

TEST(ConsiderProblem, AStepTakesResidualsAlong) {
  test::RoomOptions options = small_room();
  options.noise_px = 0.1;
  const test::PreparedRoom room(test::make_room(options));
  BundleProblem of_room = test::bundle_of(room);
  of_room.constant = {};
  ConsiderProblem problem(of_room, room.truth, 1);
  const ConsiderEquations all = problem.equations();
  const Eigen::VectorXd stay = Eigen::VectorXd::Zero(all.mixed.rows());
  Eigen::VectorXd columns = Eigen::VectorXd::Zero(problem.columns());
  const double before = problem.residuals_after(stay, columns);
  columns[0] = 0.1;  // cam0 by ten centimetres
  EXPECT_GT(problem.residuals_after(stay, columns), 10 * before);
}

}  // namespace
}  // namespace waymark
