#include "mapbuilder/bundle/reduced_problem.h"

#include <Eigen/Dense>
#include <random>
#include <set>

#include "tests/mapbuilder/bundle/bundle_of_room.h"

namespace waymark {
namespace {

const VariableCalibration kEverything{true, true, true, true};

/// A room seen by a rig whose lens is bent, with noise, so that no residual is zero.
test::RoomOptions noisy_room() {
  test::RoomOptions options;
  options.markers = 12;
  options.frame_sets = 15;
  options.room_m = 5;
  options.noise_px = 0.5;
  return options;
}

class Problem : public testing::Test {
 protected:
  [[nodiscard]] ReducedProblem problem(const VariableCalibration& variable, int threads = 1) {
    bundle.scope.variable = variable;
    return {bundle, bundle.observations, bundle.constant, room.truth, threads};
  }
  test::PreparedRoom room{test::make_room(noisy_room())};
  BundleProblem bundle = test::bundle_of(room);
};

/// The gradient against differences of the cost, variable by variable.
void expect_gradient_of_cost(ReducedProblem all) {
  // With the rigs at their optimum for the blocks the reduced gradient is the total
  // derivative; at huge damping the rigs stay and it is the partial one.
  const ReducedSystem system = all.reduce(all.start(), 1e30);
  EXPECT_NEAR(system.cost, all.cost(all.start()), 1e-9 * system.cost);
  double promised = 0;
  for (Eigen::Index i = 0; i < system.gradient.size(); ++i) {
    const double scale = std::max(1.0, std::sqrt(system.diagonal[i]));
    const double h = 1e-3 / scale;
    Eigen::VectorXd step = Eigen::VectorXd::Zero(system.gradient.size());
    step[i] = h;
    const double plus = all.cost(all.moved(all.start(), step, promised));
    step[i] = -h;
    const double minus = all.cost(all.moved(all.start(), step, promised));
    EXPECT_NEAR(system.gradient[i] / scale, (plus - minus) / (2 * h * scale), 1e-3) << "row " << i;
  }
}

TEST_F(Problem, TheGradientOfEveryVariableIsThatOfTheCost) {
  expect_gradient_of_cost(problem(kEverything));
}

TEST_F(Problem, SoItIsOfEveryLens) {
  const std::pair<Distortion, LensCoefficients> kLenses[] = {
      {Distortion::radtan5, {0.001, 0, 0, 0, -0.001}},
      {Distortion::rational, {0.001, 0, 0, 0, 0, -0.001, 0.001, 0.001}},
      {Distortion::equidistant, {0.33, -0.05, 0, 0}},
      {Distortion::eucm, {0.001, 1}},
      {Distortion::double_sphere, {0, 0.001}}};
  for (const auto& [distortion, coefficients] : kLenses) {
    SCOPED_TRACE(to_string(distortion));
    for (RigCamera& camera : room.truth.calibration.rigs.front().cameras) {
      CameraParameters p = camera.model.parameters();
      p.distortion = distortion;
      p.coefficients = coefficients;
      camera.model = *CameraModel::create(p);
    }
    ReducedProblem all = problem(kEverything);
    std::set<int> rows;
    for (int k = 0; k < kIntrinsicNumbers; ++k) rows.insert(all.layout().row_of(CameraIndex(1), k));
    EXPECT_EQ(rows.size(), static_cast<std::size_t>(kIntrinsicNumbers));
    expect_gradient_of_cost(std::move(all));
  }
}

TEST_F(Problem, UnusedRowsOfCalibrationBlocksStandStill) {
  auto all = problem(kEverything);
  const ReducedSystem system = all.reduce(all.start(), 1e-6);
  for (const int block : all.layout().size) {
    ASSERT_GE(block, 0);
    EXPECT_EQ(system.gradient.segment<5>(6 * block + 1).norm(), 0.0);
  }
  EXPECT_EQ(all.layout().extrinsics.front(), -1) << "the first camera carries the rig frame";
}

TEST_F(Problem, ThreadsDoNotChangeABit) {
  auto one = problem({}, 1);
  auto seven = problem({}, 7);
  const ReducedSystem a = one.reduce(one.start(), 1e-3);
  const ReducedSystem b = seven.reduce(seven.start(), 1e-3);
  EXPECT_EQ(a.cost, b.cost);
  EXPECT_EQ(a.gradient, b.gradient);
  ASSERT_EQ(a.information.blocks.size(), b.information.blocks.size());
  for (std::size_t i = 0; i < a.information.blocks.size(); ++i) {
    EXPECT_EQ(a.information.blocks[i], b.information.blocks[i]);
  }
  EXPECT_EQ(one.cost(one.start()), seven.cost(seven.start()));
}

TEST_F(Problem, ACornerBehindTheCameraCostsInfinitely) {
  auto plain = problem({});
  BundleVariables behind = plain.start();
  behind.world_from_rig[3] =
      behind.world_from_rig[3] *
      Rigid3{Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY())), {0, 0, 0}};
  EXPECT_TRUE(std::isinf(plain.cost(behind)));
}

}  // namespace
}  // namespace waymark
