#include "mapbuilder/calibration/scale_bound.h"

#include "mapbuilder/bundle/block_cholesky.h"

namespace waymark {
namespace {

/// The markers' normal equations alone, and per camera what a pixel of edge bias adds to their
/// right side.
struct BiasedSystem {
  BlockMatrix markers;
  Eigen::MatrixXd by_bias;  ///< −S_mb
};

BiasedSystem split(const ReducedSystem& system, const ReducedLayout& layout) {
  const auto cameras = static_cast<Eigen::Index>(layout.edge_bias.size());
  BiasedSystem result{system.information, Eigen::MatrixXd::Zero(6L * layout.blocks, cameras)};
  const BlockPattern& pattern = system.information.pattern;
  for (Eigen::Index c = 0; c < cameras; ++c) {
    const int bias = layout.edge_bias[CameraIndex(static_cast<std::size_t>(c))];
    if (bias < 0) continue;  // a camera that sees nothing
    for (int marker = 0; marker < layout.markers; ++marker) {
      const int block = pattern.find(bias, marker);
      if (block < 0) continue;
      result.by_bias.block<6, 1>(6L * marker, c) =
          -system.information.blocks[static_cast<std::size_t>(block)].row(0).transpose();
    }
    fix_block(result.markers, bias);
  }
  return result;
}

}  // namespace

IndexedVector<CameraIndex, double> scale_per_edge_px(const PreparedObservations& prepared,
                                                     const Estimate& estimate,
                                                     std::span<const ObservationIndex> observations,
                                                     FrameSetIndex anchor,
                                                     const ObservationLoss& loss, int threads) {
  std::vector<ObservationIndex> accepted;
  for (const ObservationIndex index : observations) {
    if (estimate.accepts(index)) accepted.push_back(index);
  }
  BundleProblem biased;
  biased.prepared = &prepared;
  biased.loss = loss;
  biased.constant.frame_sets = {anchor};
  biased.scope.variable.edge_bias = true;
  ReducedProblem problem(biased, accepted, biased.constant, estimate, threads);
  const int count = problem.layout().markers;
  if (count < 2) return {};
  const BiasedSystem system = split(problem.reduce(problem.start(), 0.0), problem.layout());
  BlockCholesky cholesky(system.markers.pattern);
  if (!cholesky.factorize(system.markers)) return {};
  const Eigen::MatrixXd moved = cholesky.solve(system.by_bias);

  // A turn of all leaves distances alone, a shift goes out with the mean: what is left along the
  // positions is scale.
  const std::vector<Rigid3>& poses = problem.start().world_from_marker;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Rigid3& pose : poses) centre += pose.translation / count;
  IndexedVector<CameraIndex, double> scale;
  for (Eigen::Index c = 0; c < moved.cols(); ++c) {
    double along = 0;
    double squared = 0;
    for (int m = 0; m < count; ++m) {
      const Eigen::Vector3d x = poses[static_cast<std::size_t>(m)].translation - centre;
      along += x.dot(moved.col(c).segment<3>(6L * m));
      squared += x.squaredNorm();
    }
    // By the correction of a bias the map shrinks as much as by the bias itself it has grown.
    scale.push_back(-along / squared);
  }
  return scale;
}

}  // namespace waymark
