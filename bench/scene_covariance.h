#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/camera/camera_model.h"
#include "core/geometry/rigid3.h"
#include "core/marker/marker_geometry.h"
#include "mapbuilder/evaluate/pose_accuracy.h"

namespace waymark {

/// One marker in one image.
struct SceneObservation {
  const CameraModel* camera = nullptr;
  Rigid3 cam_from_rig;
  std::size_t rig = 0;                       ///< index into SceneGeometry::world_from_rig
  std::size_t marker = 0;                    ///< index into SceneGeometry::world_from_marker
  std::array<Eigen::Matrix2d, 4> whitening;  ///< W with WᵀW = Σ⁻¹ of each corner (1/px)
};

/// Where markers hang, where rigs stood, and which rig saw which marker how well.
struct SceneGeometry {
  std::vector<Rigid3> world_from_marker;
  std::vector<double> sizes_m;  ///< per marker
  std::vector<Rigid3> world_from_rig;
  std::vector<SceneObservation> observations;
};

/// Root mean squares of poses' errors as an evaluation against the truth shows them.
struct SceneRmse {
  PoseRmse markers;      ///< aligned on the markers' positions
  PoseRmse rigs;         ///< aligned on the rigs' positions
  PoseRmse rigs_in_map;  ///< carried by the markers' alignment
};

/// How well all poses of a scene can be known together: C = (Σ Jᵀ Σ_px⁻¹ J)⁺ over the corners of
/// all observations, extrinsics and intrinsics known. At the truth it is the Cramér–Rao bound of
/// any unbiased mapper, at a finished map the map's own joint covariance. Dense: for some hundred
/// poses.
///
/// The six freedoms of the world frame are taken out as an evaluation does it, by aligning on
/// positions: C_aligned = P C Pᵀ, P = I − N (GᵀN)⁻¹ Gᵀ with N the motions of the world and G their
/// rows at the positions aligned on. Any generalized inverse of the singular information gives the
/// same.
class SceneCovariance {
 public:
  /// nullopt when a corner can't be projected, or the observations leave more free than the world
  /// frame. Positions of markers and of rigs must each extend beyond a line.
  [[nodiscard]] static std::optional<SceneCovariance> of(const SceneGeometry& scene);

  /// √E[mean of squared errors].
  [[nodiscard]] SceneRmse expected() const;

  /// What corners that are all off by known amounts do to the poses: first-order answer of the
  /// least-squares solution. One entry per observation, px.
  [[nodiscard]] SceneRmse response(std::span<const ImageCorners> shifts_px) const;

  /// Quantile of each RMSE over `samples` Gaussian draws from the covariance.
  [[nodiscard]] SceneRmse quantile(double probability, int samples, std::uint64_t seed) const;

  /// Joint 6M×6M covariance of the markers, in Rigid3's tangent (m, rad; world axes), aligned on
  /// the markers' positions: of rank 6M − 6.
  [[nodiscard]] Eigen::MatrixXd marker_covariance() const;

  /// Its 6×6 blocks on the diagonal, one per marker: what a map stores.
  [[nodiscard]] std::vector<Matrix6d> marker_blocks() const;

  /// eᵀ C⁺ e of the markers' error e (6M, so aligned) with C = marker_covariance(): χ² of 6M − 6
  /// degrees of freedom when C tells the truth. For aligned errors the reduced information is C⁺.
  [[nodiscard]] double marker_chi2(const Eigen::VectorXd& error) const;

  /// Degrees of freedom of marker_chi2.
  [[nodiscard]] std::size_t marker_freedom() const { return 6 * markers_ - 6; }

 private:
  SceneCovariance() = default;

  /// One column per displacement of all poses; what is left of each pose after alignment.
  struct Aligned {
    Eigen::MatrixXd markers, rigs, rigs_in_map;
  };
  [[nodiscard]] Aligned align(const Eigen::MatrixXd& displacements) const;
  /// The markers' part of the root, aligned on their positions.
  [[nodiscard]] Eigen::MatrixXd aligned_marker_root() const;

  /// One observation's part of the normal equations, its marker's six rows first.
  struct Part {
    std::size_t marker = 0;
    std::size_t rig = 0;
    Eigen::Matrix<double, 12, 12> information = Eigen::Matrix<double, 12, 12>::Zero();
    std::array<Eigen::Matrix<double, 12, 2>, 4> gains;  ///< −Jᵀ Σ_px⁻¹ per corner
  };

  [[nodiscard]] bool linearize(const SceneGeometry& scene);
  [[nodiscard]] bool invert();

  std::size_t markers_ = 0;
  std::size_t rigs_ = 0;
  std::vector<Part> parts_;
  Eigen::MatrixXd world_motions_;  ///< N: 6 rows per pose, markers first; shift, turn
  Eigen::MatrixXd information_;    ///< of the markers, with the rigs eliminated
  Eigen::MatrixXd root_;           ///< R Rᵀ is a generalized inverse of the information
};

}  // namespace waymark
