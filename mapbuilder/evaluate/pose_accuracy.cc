#include "mapbuilder/evaluate/pose_accuracy.h"

#include <cmath>

#include "core/geometry/alignment.h"
#include "core/marker/marker_geometry.h"

namespace waymark {
namespace {

/// Both alignments of the same data: with the scale fixed to 1, and free.
struct Alignments {
  Similarity3 rigid;
  Similarity3 similar;
};

/// Paired points of estimate and truth.
struct PointPairs {
  std::vector<Eigen::Vector3d> estimate;
  std::vector<Eigen::Vector3d> truth;
};

/// nullopt where the points lie on a line.
std::optional<Alignments> align(const PointPairs& points) {
  const auto rigid = align_points(points.estimate, points.truth, false);
  const auto similar = align_points(points.estimate, points.truth, true);
  if (!rigid || !similar) return std::nullopt;
  return Alignments{*rigid, *similar};
}

PointPairs positions_of(std::span<const PosePair> poses) {
  PointPairs points;
  for (const PosePair& pose : poses) {
    points.estimate.push_back(pose.estimate.translation);
    points.truth.push_back(pose.truth.translation);
  }
  return points;
}

PointPairs corners_of(std::span<const MarkerPair> markers) {
  PointPairs points;
  for (const MarkerPair& marker : markers) {
    for (const Eigen::Vector3d& corner : marker_corners(marker.size_m)) {
      points.estimate.push_back(marker.pose.estimate * corner);
      points.truth.push_back(marker.pose.truth * corner);
    }
  }
  return points;
}

std::optional<Alignments> align_whole_poses(std::span<const PosePair> poses) {
  std::vector<Rigid3> estimate;
  std::vector<Rigid3> truth;
  for (const PosePair& pose : poses) {
    estimate.push_back(pose.estimate);
    truth.push_back(pose.truth);
  }
  const auto rigid = align_poses(estimate, truth, false);
  const auto similar = align_poses(estimate, truth, true);
  if (!rigid || !similar) return std::nullopt;
  return Alignments{*rigid, *similar};
}

PoseAccuracy accuracy_after(const Alignments& alignments, std::span<const PosePair> poses) {
  PoseAccuracy accuracy;
  accuracy.truth_from_estimate = alignments.rigid.motion;
  accuracy.each = pose_errors(poses, accuracy.truth_from_estimate);
  accuracy.rmse = rmse_of(accuracy.each);
  accuracy.scale = alignments.similar.scale;
  double squares = 0;
  for (const PosePair& pose : poses) {
    squares +=
        (pose.truth.translation - alignments.similar * pose.estimate.translation).squaredNorm();
  }
  accuracy.sim3_translation_rmse_m = std::sqrt(squares / static_cast<double>(poses.size()));
  return accuracy;
}

}  // namespace

std::optional<PoseAccuracy> accuracy_of_markers(std::span<const MarkerPair> markers) {
  std::vector<PosePair> poses;
  for (const MarkerPair& marker : markers) poses.push_back(marker.pose);
  auto alignments = align(positions_of(poses));
  const bool on_a_line = !alignments;
  if (on_a_line) alignments = align(corners_of(markers));
  if (!alignments) return std::nullopt;
  PoseAccuracy accuracy = accuracy_after(*alignments, poses);
  accuracy.positions_on_a_line = on_a_line;
  return accuracy;
}

std::optional<PoseAccuracy> accuracy_of_cameras(std::span<const PosePair> poses) {
  auto alignments = align(positions_of(poses));
  const bool on_a_line = !alignments;
  if (on_a_line) alignments = align_whole_poses(poses);
  if (!alignments) return std::nullopt;
  PoseAccuracy accuracy = accuracy_after(*alignments, poses);
  accuracy.positions_on_a_line = on_a_line;
  return accuracy;
}

std::vector<PoseError> pose_errors(std::span<const PosePair> poses,
                                   const Rigid3& truth_from_estimate) {
  std::vector<PoseError> errors;
  for (const PosePair& pose : poses) {
    const Rigid3 aligned = truth_from_estimate * pose.estimate;
    errors.push_back({(pose.truth.translation - aligned.translation).norm(),
                      angle_between_rad(pose.truth.rotation, aligned.rotation)});
  }
  return errors;
}

PoseRmse rmse_of(std::span<const PoseError> errors) {
  if (errors.empty()) return {};
  PoseRmse sum;
  for (const PoseError& error : errors) {
    sum.translation_m += error.translation_m * error.translation_m;
    sum.rotation_rad += error.rotation_rad * error.rotation_rad;
  }
  const auto count = static_cast<double>(errors.size());
  return {std::sqrt(sum.translation_m / count), std::sqrt(sum.rotation_rad / count)};
}

}  // namespace waymark
