#include "core/geometry/alignment.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/geometry/decompositions.h"

namespace waymark {
namespace {

/// Second singular value of the centred points over the first, below which points count as lying on
/// a line.
constexpr double kLineRatio = 1e-6;

Eigen::Vector3d mean_of(std::span<const Eigen::Vector3d> points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& x : points) sum += x;
  return sum / static_cast<double>(points.size());
}

/// Points less their mean, as columns.
Eigen::Matrix3Xd centred(std::span<const Eigen::Vector3d> points) {
  const Eigen::Vector3d mean = mean_of(points);
  Eigen::Matrix3Xd columns(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    columns.col(static_cast<Eigen::Index>(i)) = points[i] - mean;
  }
  return columns;
}

/// Scale, and translation that carries the mean of `source` to that of `target`, given the
/// rotation.
Similarity3 complete(const Eigen::Quaterniond& rotation, std::span<const Eigen::Vector3d> source,
                     std::span<const Eigen::Vector3d> target, bool with_scale) {
  Similarity3 result;
  result.motion.rotation = rotation;
  if (with_scale) {
    const Eigen::Matrix3Xd from = centred(source);
    const double along = centred(target).cwiseProduct(rotation.toRotationMatrix() * from).sum();
    const double extent = from.squaredNorm();
    if (extent > 0 && along > 0) result.scale = along / extent;
  }
  result.motion.translation = mean_of(target) - rotation * (result.scale * mean_of(source));
  return result;
}

std::vector<Eigen::Vector3d> positions_of(std::span<const Rigid3> poses) {
  std::vector<Eigen::Vector3d> positions(poses.size());
  std::transform(poses.begin(), poses.end(), positions.begin(),
                 [](const Rigid3& pose) { return pose.translation; });
  return positions;
}

}  // namespace

bool lie_on_a_line(std::span<const Eigen::Vector3d> points) {
  if (points.size() < 3) return true;
  const Eigen::Matrix3Xd columns = centred(points);
  const Eigen::Matrix3d scatter = columns * columns.transpose();
  const Eigen::Vector3d squares = symmetric_eigenvalues<3>(scatter);  // ascending
  return squares[1] <= kLineRatio * kLineRatio * squares[2];
}

std::optional<Similarity3> align_points(std::span<const Eigen::Vector3d> source,
                                        std::span<const Eigen::Vector3d> target, bool with_scale) {
  WAYMARK_CHECK(source.size() == target.size());
  if (lie_on_a_line(source) || lie_on_a_line(target)) return std::nullopt;
  const Eigen::Matrix3d correlation = centred(target) * centred(source).transpose();
  const SingularVectors svd = singular_vectors(correlation);
  // Umeyama's equation 43: a rotation, never a reflection.
  Eigen::Vector3d signs(1, 1, 1);
  if (svd.u.determinant() * svd.v.determinant() < 0) signs.z() = -1;
  const Eigen::Matrix3d rotation = svd.u * signs.asDiagonal() * svd.v.transpose();
  return complete(Eigen::Quaterniond(rotation).normalized(), source, target, with_scale);
}

std::optional<Similarity3> align_poses(std::span<const Rigid3> source,
                                       std::span<const Rigid3> target, bool with_scale) {
  WAYMARK_CHECK(source.size() == target.size());
  if (source.empty()) return std::nullopt;
  // The chordal mean of rotations is the main eigenvector of Σ q qᵀ (Markley et al. 2007).
  Eigen::Matrix4d moment = Eigen::Matrix4d::Zero();
  for (std::size_t i = 0; i < source.size(); ++i) {
    const Eigen::Vector4d q = (target[i].rotation * source[i].rotation.conjugate()).coeffs();
    moment += q * q.transpose();
  }
  const Eigen::Quaterniond rotation(Eigen::Vector4d(symmetric_eigen<4>(moment).vectors.col(3)));
  return complete(rotation.normalized(), positions_of(source), positions_of(target), with_scale);
}

}  // namespace waymark
