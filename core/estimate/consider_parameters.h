#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "core/camera/rig_parameters.h"

namespace waymark {

/// A stated print size that markers share.
struct StatedSize {
  double size_m = 0;
  double sigma = 0;  ///< one standard deviation, as a share of it
};

/// A number that is not estimated, but considered: it may be wrong, in the same way in every
/// image, and every covariance counts with that (Schmidt, 1966; ERRORS e).
struct ConsiderParameter {
  std::size_t rig = 0;  ///< among several
  RigParameter of_rig;  ///< where it is none of a size
  double size_m = 0;    ///< > 0: the factor of this stated size
  [[nodiscard]] bool is_size() const { return size_m > 0; }

  bool operator==(const ConsiderParameter&) const = default;
};

/// All of them: rig by rig in the order of rig_parameters, then sizes, rising.
struct ConsiderParameters {
  std::vector<ConsiderParameter> all;
  /// Of what is true less what is used: m and rad of the rig's axes, shares of the focal length,
  /// px, k1, s; of sizes shares.
  Eigen::MatrixXd covariance;

  [[nodiscard]] Eigen::Index count() const { return covariance.rows(); }
};

/// Those of rigs and of sizes, each of them once. Half the variance of edges is common to all
/// cameras, that of sizes to all sizes.
[[nodiscard]] ConsiderParameters consider_parameters(std::span<const Rig> rigs,
                                                     std::span<const StatedSize> sizes,
                                                     const SigmaCircumstances& circumstances = {});

/// "cam1 position y", "rig1 cam0 k1" (of the second of several rigs), "size 0.16 m": at most
/// kMaxParameterName bytes, the same in every program.
[[nodiscard]] std::string name_of(const ConsiderParameter& parameter, std::span<const Rig> rigs);

inline constexpr std::size_t kMaxParameterName = 48;

/// What a corner residual is differentiated by of one camera and one marker's size: rows 0–5
/// rig_from_cam (Rigid3's tangent), 6–17 fu fv pu pv and the coefficients (CalibrationJacobians),
/// 18 edges' offset outward (px), 19 factor of the size.
inline constexpr int kIntrinsicsRow = 6;
inline constexpr int kEdgeRow = kIntrinsicsRow + kIntrinsicNumbers;
inline constexpr int kSizeRow = kEdgeRow + 1;
using CalibrationTangent = Eigen::Matrix<double, kSizeRow + 1, 1>;

/// How that moves per unit of the parameter, for the camera (of the parameter's rig) or for any
/// marker of its size. Zero of stamp and read-out: these move corners with the rig's velocity v,
/// J_x v and (row / height − ½) J_x v.
[[nodiscard]] CalibrationTangent tangent_of(const ConsiderParameter& parameter,
                                            const CameraModel& camera);

/// L of covariance = L Lᵀ, as many columns as rows, by the eigenvectors of the correlations; what
/// rounding makes negative counts as 0.
[[nodiscard]] Eigen::MatrixXd square_root_of(const Eigen::MatrixXd& covariance);

}  // namespace waymark
