#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/range.h"
#include "core/camera/camera_model.h"
#include "core/capture/detection.h"
#include "core/estimate/corner_residual.h"
#include "core/estimate/ippe.h"
#include "core/estimate/pose_minimizer.h"
#include "core/estimate/robust_loss.h"
#include "core/geometry/rigid3.h"

namespace waymark {

/// One marker in one image, prepared for estimation.
struct MarkerObservation {
  int camera = 0;  ///< index in the rig
  double size_m = 0;
  ImageCorners corners_px;
  /// W with WᵀW = Σ⁻¹ (1/px): W·χ is a corner's residual in sigmas.
  std::array<Eigen::Matrix2d, 4> whitening;
  std::optional<IppeSolutions> ippe;  ///< nullopt: degenerate, can't seed anything
};

/// An observation whose eight residuals together exceed this (sigmas) is an outlier: its square is
/// exceeded by 1 of 56,000 of χ² with 8 degrees of freedom.
inline constexpr double kInlierSigmas = 6.0;
inline constexpr double kInlierSigmas2 = kInlierSigmas * kInlierSigmas;

/// How much a marker's eight whitened residuals together may weigh. The loss sees the marker as a
/// whole, because a wrong id, a moved or a half-covered marker is wrong in all its corners.
struct ObservationLoss {
  Loss loss = Loss::huber;
  /// Sigmas. Real observations have wider tails than Gaussian ones; Huber's loss still counts
  /// them. Of no meaning to Loss::squared.
  double scale_sigmas = kInlierSigmas;

  static constexpr Range kScaleSigmas{2, 50};
  /// usage, naming the field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// A corner predicted farther off than this (half the image's diagonal, px) does not tell which way
/// to go: near the camera plane its derivatives grow without bound, and one wrong id would outweigh
/// a whole frame set even under Huber's loss. It still counts as a misfit.
[[nodiscard]] double gross_residual_px(const CameraModel& camera);

/// W = L⁻¹ with L Lᵀ = Σ, for a positive definite Σ (px²).
[[nodiscard]] Eigen::Matrix2d whitening_from_covariance(const Eigen::Matrix2d& covariance);

/// Squared residual of an observation in sigmas²: Σ over four corners |W χ|². A marker with a
/// corner that can't be projected counts as 1e4 sigmas off, whatever its other corners say.
[[nodiscard]] double squared_residual(const MarkerObservation& observation,
                                      const CameraModel& camera, const Rigid3& cam_from_marker);

/// Corner residuals χ = x − π (px); nullopt when one can't be projected.
[[nodiscard]] std::optional<std::array<Eigen::Vector2d, 4>> corner_residuals(
    const MarkerObservation& observation, const CameraModel& camera, const Rigid3& cam_from_marker);

/// Where an observation stands: its camera on the rig, the rig and the marker in the world.
struct ObservationGeometry {
  const CameraModel* camera = nullptr;
  Rigid3 cam_from_rig;
  Rigid3 world_from_rig;
  Rigid3 world_from_marker;
};

/// What a corner leaves there, and how that changes.
struct LinearizedCorner {
  Eigen::Vector2d residual_px;  ///< χ
  Eigen::Vector2d residual;     ///< W χ, sigmas
  CornerJacobians jacobians;    ///< of χ
};

/// An observation's four corners where it stands, its marker `times` as wide and as high as it
/// says; nullopt when one can't be projected. Everything that estimates poses, sizes or their
/// uncertainty with known lenses is made of this; only the bundle's ReducedProblem, which moves
/// lenses and edges as well, takes corner_residual itself.
[[nodiscard]] std::optional<std::array<LinearizedCorner, 4>> linearize_corners(
    const MarkerObservation& observation, const ObservationGeometry& geometry,
    const Eigen::Vector2d& times = Eigen::Vector2d::Ones());

/// Which end of the chain moves.
enum class FreePose { rig, marker };

/// Adds one observation, robustly weighted, to the equations of the pose that is free; a gross one
/// only to their cost.
void add_observation(const MarkerObservation& observation, const ObservationGeometry& geometry,
                     const ObservationLoss& loss, FreePose free, PoseEquations& equations);

}  // namespace waymark
