#include "mapbuilder/bundle/calibration_uncertainty.h"

#include <cmath>
#include <limits>

#include "core/camera/lens_kind.h"
#include "mapbuilder/bundle/block_cholesky.h"

namespace waymark {
namespace {

/// See CalibrationUncertainty::joint; zero rows where it is constant.
Eigen::MatrixXd joint_covariance(const ReducedLayout& layout, const BundleVariables& at,
                                 const BlockCholesky& cholesky) {
  std::vector<int> row_of;  // −1: constant
  for (const int block : layout.extrinsics) {
    for (int r = 0; r < 6; ++r) row_of.push_back(block < 0 ? -1 : 6 * block + r);
  }
  for (const CameraIndex c : layout.focal.indices()) {
    // A row that the lens has not carries a unit diagonal and says nothing.
    const int numbers = 4 + lens_kind(at.cameras[c].model.parameters().distortion).count();
    for (int k = 0; k < kIntrinsicNumbers; ++k) {
      row_of.push_back(k < numbers ? layout.row_of(c, k) : -1);
    }
  }
  const auto count = static_cast<Eigen::Index>(row_of.size());
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(6L * layout.blocks, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const int row = row_of[static_cast<std::size_t>(i)];
    if (row >= 0) unit(row, i) = 1.0;
  }
  return unit.transpose() * cholesky.solve(unit);
}

}  // namespace

CalibrationUncertainty uncertainty_of(ReducedProblem& problem, const BundleVariables& at) {
  const ReducedLayout& layout = problem.layout();
  // Reduced first: that is what makes the pattern where another solver found the optimum.
  const auto system = problem.reduce(at, 0.0);
  BlockCholesky cholesky(problem.pattern());
  const bool determined = cholesky.factorize(system.information);
  const std::vector<Matrix6d> covariance =
      determined ? cholesky.inverse_diagonal() : std::vector<Matrix6d>{};
  const auto sigma = [&](int block, int first, int count) {
    if (block < 0) return 0.0;
    if (!determined) return std::numeric_limits<double>::infinity();
    const auto diagonal = covariance[static_cast<std::size_t>(block)].diagonal();
    return std::sqrt(diagonal.segment(first, count).maxCoeff());
  };
  CalibrationUncertainty uncertainty;
  for (const CameraIndex c : at.cameras.indices()) {
    const CameraParameters& camera = at.cameras[c].model.parameters();
    uncertainty.cameras.push_back(
        {sigma(layout.extrinsics[c], 0, 3), sigma(layout.extrinsics[c], 3, 3),
         sigma(layout.focal[c], 0, 2) / camera.fu_px, sigma(layout.edge_bias[c], 0, 1)});
  }
  for (const int block : layout.size) uncertainty.size_factor.push_back(sigma(block, 0, 1));
  if (determined) uncertainty.joint = joint_covariance(layout, at, cholesky);
  return uncertainty;
}

}  // namespace waymark
