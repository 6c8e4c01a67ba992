#include "bench/scene_covariance.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>

#include "core/base/check.h"
#include "core/estimate/corner_residual.h"
#include "core/geometry/symmetric_factor.h"

namespace waymark {
namespace {

/// Draws that are made at once: matrix products are quicker than vectors one by one.
constexpr int kDrawsAtOnce = 256;

/// First of the six rows of a pose.
Eigen::Index row_of(std::size_t pose) { return static_cast<Eigen::Index>(6 * pose); }

/// N about the poses' centre, so that its columns are of like size.
Eigen::MatrixXd world_motions(const std::vector<Rigid3>& poses) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Rigid3& pose : poses) centre += pose.translation / static_cast<double>(poses.size());
  Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(row_of(poses.size()), 6);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    auto rows = motions.middleRows<6>(row_of(i));
    rows.topLeftCorner<3, 3>().setIdentity();
    rows.topRightCorner<3, 3>() = -skew(poses[i].translation - centre);
    rows.bottomRightCorner<3, 3>().setIdentity();
  }
  return motions;
}

/// (AᵀA)⁻¹ of six columns.
Matrix6d gram_inverse(const Eigen::MatrixXd& columns) {
  return SymmetricFactor<6>(columns.transpose() * columns).inverse();
}

/// The motions of the world that least squares over positions finds in each displacement:
/// (GᵀN)⁻¹ Gᵀ δ; then GᵀN = GᵀG, for G is N without the rotations' rows.
Eigen::MatrixXd fitted_motions(const Eigen::MatrixXd& motions,
                               const Eigen::MatrixXd& displacements) {
  Eigen::MatrixXd positions = motions;
  for (Eigen::Index i = 0; i < positions.rows(); i += 6) positions.middleRows<3>(i + 3).setZero();
  return gram_inverse(positions) * (positions.transpose() * displacements);
}

/// R with R Rᵀ = information⁻¹; nullopt where it has none.
std::optional<Eigen::MatrixXd> root_of_inverse(const Eigen::MatrixXd& information) {
  const Eigen::LLT<Eigen::MatrixXd> factor(information);
  if (factor.info() != Eigen::Success) return std::nullopt;
  Eigen::MatrixXd root = Eigen::MatrixXd::Identity(information.rows(), information.cols());
  factor.matrixU().solveInPlace(root);
  return root;
}

/// Root mean squares over poses of one column each of translations and rotations.
PoseRmse rmse_of_column(const Eigen::MatrixXd& errors, Eigen::Index column) {
  PoseRmse sum;
  for (Eigen::Index i = 0; i < errors.rows(); i += 6) {
    sum.translation_m += errors.col(column).segment<3>(i).squaredNorm();
    sum.rotation_rad += errors.col(column).segment<3>(i + 3).squaredNorm();
  }
  const double poses = static_cast<double>(errors.rows()) / 6.0;
  return {std::sqrt(sum.translation_m / poses), std::sqrt(sum.rotation_rad / poses)};
}

/// The same over all columns together: with a covariance's root, the expectation.
PoseRmse rmse_of_all(const Eigen::MatrixXd& errors) {
  PoseRmse sum;
  for (Eigen::Index i = 0; i < errors.rows(); i += 6) {
    sum.translation_m += errors.middleRows<3>(i).squaredNorm();
    sum.rotation_rad += errors.middleRows<3>(i + 3).squaredNorm();
  }
  const double poses = static_cast<double>(errors.rows()) / 6.0;
  return {std::sqrt(sum.translation_m / poses), std::sqrt(sum.rotation_rad / poses)};
}

PoseRmse quantile_of(std::vector<PoseRmse>& draws, double probability) {
  const auto at = static_cast<std::size_t>(probability * static_cast<double>(draws.size() - 1));
  const auto pick = [&](double PoseRmse::*part) {
    std::nth_element(draws.begin(), draws.begin() + static_cast<std::ptrdiff_t>(at), draws.end(),
                     [part](const PoseRmse& a, const PoseRmse& b) { return a.*part < b.*part; });
    return draws[at].*part;
  };
  return {pick(&PoseRmse::translation_m), pick(&PoseRmse::rotation_rad)};
}

}  // namespace

std::optional<SceneCovariance> SceneCovariance::of(const SceneGeometry& scene) {
  SceneCovariance result;
  result.markers_ = scene.world_from_marker.size();
  result.rigs_ = scene.world_from_rig.size();
  if (!result.linearize(scene) || !result.invert()) return std::nullopt;
  return result;
}

bool SceneCovariance::linearize(const SceneGeometry& scene) {
  std::vector<Rigid3> poses = scene.world_from_marker;
  poses.insert(poses.end(), scene.world_from_rig.begin(), scene.world_from_rig.end());
  world_motions_ = world_motions(poses);
  for (const SceneObservation& o : scene.observations) {
    const CornerChain chain(*o.camera, o.cam_from_rig, scene.world_from_rig[o.rig],
                            scene.world_from_marker[o.marker]);
    const auto x_in_marker = marker_corners(scene.sizes_m[o.marker]);
    Part& part = parts_.emplace_back();
    part.marker = o.marker;
    part.rig = o.rig;
    for (std::size_t i = 0; i < 4; ++i) {
      CornerJacobians jacobians;
      if (!corner_residual(chain, x_in_marker[i], Eigen::Vector2d::Zero(), &jacobians)) {
        return false;
      }
      Eigen::Matrix<double, 2, 12> j;
      j << jacobians.d_marker, jacobians.d_rig;
      // The residual is observed − predicted: a corner that moves takes the prediction after it.
      part.gains[i] = -j.transpose() * (o.whitening[i].transpose() * o.whitening[i]);
      part.information -= part.gains[i] * j;
    }
  }
  return true;
}

bool SceneCovariance::invert() {
  const Eigen::Index markers = row_of(markers_);
  const Eigen::Index size = row_of(markers_ + rigs_);
  std::vector<Matrix6d> rig_information(rigs_, Matrix6d::Zero());
  std::vector<std::vector<const Part*>> parts_of_rig(rigs_);
  for (const Part& part : parts_) {
    rig_information[part.rig] += part.information.bottomRightCorner<6, 6>();
    parts_of_rig[part.rig].push_back(&part);
  }

  // Rigs are eliminated, for they meet each other only through markers.
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(markers, markers);
  root_ = Eigen::MatrixXd::Zero(size, size);
  std::vector<Matrix6d> rig_covariance(rigs_);
  for (std::size_t rig = 0; rig < rigs_; ++rig) {
    const auto own = root_of_inverse(rig_information[rig]);
    if (!own) return false;
    rig_covariance[rig] = *own * own->transpose();
    for (const Part* a : parts_of_rig[rig]) {
      information.block<6, 6>(row_of(a->marker), row_of(a->marker)) +=
          a->information.topLeftCorner<6, 6>();
      const Matrix6d follows = rig_covariance[rig] * a->information.bottomLeftCorner<6, 6>();
      for (const Part* b : parts_of_rig[rig]) {
        information.block<6, 6>(row_of(b->marker), row_of(a->marker)) -=
            b->information.topRightCorner<6, 6>() * follows;
      }
    }
    root_.block<6, 6>(row_of(markers_ + rig), row_of(markers_ + rig)) = *own;
  }

  // Fixing the world's motions by a soft weight of the information's own size leaves everything
  // else as it is, for the information says nothing about them.
  const Eigen::MatrixXd motions = world_motions_.topRows(markers);
  information_ = information;
  const double weight = information.diagonal().mean();
  information += weight * (motions * gram_inverse(motions)) * motions.transpose();
  const auto of_markers = root_of_inverse(information);
  if (!of_markers) return false;
  // A pose that nothing fixes passes Cholesky by rounding, with a variance beyond all reason.
  constexpr double kMostSigma = 10.0;  // m and rad
  if (!(of_markers->rowwise().norm().maxCoeff() < kMostSigma)) return false;
  root_.topLeftCorner(markers, markers) = *of_markers;
  for (std::size_t rig = 0; rig < rigs_; ++rig) {
    for (const Part* part : parts_of_rig[rig]) {
      const Matrix6d follows = rig_covariance[rig] * part->information.bottomLeftCorner<6, 6>();
      root_.block(row_of(markers_ + rig), 0, 6, markers) -=
          follows * of_markers->middleRows<6>(row_of(part->marker));
    }
  }
  return true;
}

SceneCovariance::Aligned SceneCovariance::align(const Eigen::MatrixXd& displacements) const {
  const Eigen::Index markers = row_of(markers_);
  const Eigen::Index rigs = row_of(rigs_);
  const Eigen::MatrixXd marker_motions = world_motions_.topRows(markers);
  const Eigen::MatrixXd rig_motions = world_motions_.bottomRows(rigs);
  const auto of_markers = displacements.topRows(markers);
  const auto of_rigs = displacements.bottomRows(rigs);
  const Eigen::MatrixXd by_markers = fitted_motions(marker_motions, of_markers);
  const Eigen::MatrixXd by_rigs = fitted_motions(rig_motions, of_rigs);
  return {of_markers - marker_motions * by_markers, of_rigs - rig_motions * by_rigs,
          of_rigs - rig_motions * by_markers};
}

SceneRmse SceneCovariance::expected() const {
  const Aligned aligned = align(root_);
  return {rmse_of_all(aligned.markers), rmse_of_all(aligned.rigs),
          rmse_of_all(aligned.rigs_in_map)};
}

SceneRmse SceneCovariance::response(std::span<const ImageCorners> shifts_px) const {
  WAYMARK_CHECK(shifts_px.size() == parts_.size());
  Eigen::VectorXd pulled = Eigen::VectorXd::Zero(root_.rows());
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    const Part& part = parts_[k];
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Matrix<double, 12, 1> pull = part.gains[i] * shifts_px[k][i];
      pulled.segment<6>(row_of(part.marker)) += pull.head<6>();
      pulled.segment<6>(row_of(markers_ + part.rig)) += pull.tail<6>();
    }
  }
  const Aligned aligned = align(root_ * (root_.transpose() * pulled));
  return {rmse_of_column(aligned.markers, 0), rmse_of_column(aligned.rigs, 0),
          rmse_of_column(aligned.rigs_in_map, 0)};
}

SceneRmse SceneCovariance::quantile(double probability, int samples, std::uint64_t seed) const {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<PoseRmse> markers;
  std::vector<PoseRmse> rigs;
  std::vector<PoseRmse> rigs_in_map;
  for (int done = 0; done < samples; done += kDrawsAtOnce) {
    const int count = std::min(kDrawsAtOnce, samples - done);
    const Eigen::MatrixXd draws =
        Eigen::MatrixXd::NullaryExpr(root_.cols(), count, [&] { return normal(engine); });
    const Aligned aligned = align(root_ * draws);
    for (int i = 0; i < count; ++i) {
      markers.push_back(rmse_of_column(aligned.markers, i));
      rigs.push_back(rmse_of_column(aligned.rigs, i));
      rigs_in_map.push_back(rmse_of_column(aligned.rigs_in_map, i));
    }
  }
  return {quantile_of(markers, probability), quantile_of(rigs, probability),
          quantile_of(rigs_in_map, probability)};
}

Eigen::MatrixXd SceneCovariance::aligned_marker_root() const {
  const Eigen::Index markers = row_of(markers_);
  const Eigen::MatrixXd motions = world_motions_.topRows(markers);
  const Eigen::MatrixXd of_markers = root_.topLeftCorner(markers, markers);
  return of_markers - motions * fitted_motions(motions, of_markers);
}

Eigen::MatrixXd SceneCovariance::marker_covariance() const {
  const Eigen::MatrixXd aligned = aligned_marker_root();
  return aligned * aligned.transpose();
}

std::vector<Matrix6d> SceneCovariance::marker_blocks() const {
  const Eigen::MatrixXd aligned = aligned_marker_root();
  std::vector<Matrix6d> blocks;
  for (std::size_t i = 0; i < markers_; ++i) {
    const auto rows = aligned.middleRows<6>(row_of(i));
    blocks.emplace_back(rows * rows.transpose());
  }
  return blocks;
}

double SceneCovariance::marker_chi2(const Eigen::VectorXd& error) const {
  return error.dot(information_ * error);
}

}  // namespace waymark
