#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/camera/rig.h"
#include "core/capture/detection.h"
#include "core/estimate/rig_pose_solver.h"
#include "locd/map_index.h"
#include "locd/motion_filter.h"

namespace waymark {

/// One detection of a mapped, unquarantined marker, on its way into a pose.
struct SetObservation {
  MarkerObservation observation;    ///< corners as they would be at the set's stamp
  ImageCorners detected_px;         ///< as detected
  CornerCovariances stated;         ///< the detector's (px²); zero when it states none
  std::array<double, 4> after_s{};  ///< each corner's instant less the set's stamp
  std::size_t map_index = 0;
  std::size_t report_index = 0;  ///< into PoseEstimate::observations
  bool inlier = false;
  double sigmas_squared = 0;  ///< at the pose; 8 degrees of freedom
  double rms_px = 0;
};

/// A set's pose by all corners of all cameras.
struct PoseSolution {
  Rigid3 world_from_rig;
  Matrix6d covariance = Matrix6d::Zero();
  Matrix6d noise_covariance = Matrix6d::Zero();  ///< of that the inverse Hessian alone
  bool ambiguous = false;
  int inliers = 0;
  int inlier_markers = 0;   ///< different ones
  int outlier_markers = 0;  ///< different ones that no inlier shows
};

/// Options of RobustPose.
struct RobustPoseOptions {
  /// Markers beyond are outliers: 36 is exceeded by 1 of 56,000 of χ² with 8 degrees of freedom.
  double inlier_sigmas = 6.0;  ///< (4–20)
  /// Where Tukey's loss, which has the last word before inliers are told, is flat. (6–40 sigmas)
  double tukey_sigmas = 12.0;
  int seed_observations = 8;       ///< largest ones that seed, where the prior explains the set
  int all_seed_observations = 32;  ///< the same where it does not
};

/// One robust optimization over all corners of all cameras with the map's markers fixed (core's
/// Algorithm 1): starts from the prior and from fresh IPPE candidates, so that a wrong prior can't
/// hold it; Huber's loss finds the way, Tukey's lets go of what does not belong, and least squares
/// over the inliers has the full efficiency. Corners of other instants than the set's (free-running
/// cameras, rolling shutters) are moved by what the velocity does to them.
///
/// The covariance is the solve's own (the corners' noise through it), plus the velocity's, plus the
/// map's: markers' marginals with unknown correlations, by the bound that holds for any:
/// (Σ √tr)²-weighted, so n markers that are wrong alike are never taken for n independent ones.
class RobustPose {
 public:
  RobustPose(const Rig& rig, const MapIndex& map, const RobustPoseOptions& options);

  /// nullopt when nothing explains what was seen. Marks inliers and writes residuals into
  /// `observations`. `velocity` is that of `prior`, or zero ± what is believed of it at first.
  [[nodiscard]] std::optional<PoseSolution> solve(std::span<SetObservation> observations,
                                                  const std::optional<MotionPrediction>& prior,
                                                  const Vector6d& velocity,
                                                  const Matrix6d& velocity_covariance,
                                                  double model_sigma_px);

  /// Residuals and verdicts of further observations, which take no part, at a pose.
  void hold_against(std::span<SetObservation> observations, const Rigid3& world_from_rig,
                    const Vector6d& velocity, double model_sigma_px) const;

  [[nodiscard]] const RigPoseSolver& solver() const { return solver_; }

 private:
  struct MarkerShare {  ///< of one marker in the pose: −H⁻¹ΣJᵀWJ_marker
    std::size_t map_index = 0;
    Matrix6d gain = Matrix6d::Zero();
  };

  void whiten(std::span<SetObservation> observations, double model_sigma_px) const;
  void whiten_with_map(std::span<SetObservation> observations, const Rigid3& pose,
                       double model_sigma_px) const;
  void to_set_instant(std::span<SetObservation> observations, const Rigid3& pose,
                      const Vector6d& velocity) const;
  void seed(std::span<SetObservation> observations, std::size_t count);
  void collect(std::span<SetObservation> observations, bool inliers_only);
  int classify(std::span<SetObservation> observations, const Rigid3& pose) const;
  void state_covariance(std::span<const SetObservation> observations,
                        const Matrix6d& velocity_covariance, double model_sigma_px,
                        PoseSolution& solution);
  void count_markers(std::span<const SetObservation> observations, PoseSolution& solution);

  const MapIndex& map_;
  RobustPoseOptions options_;
  RigPoseSolver solver_;
  std::vector<FixedMarkerObservation> fixed_;
  std::vector<std::pair<double, std::size_t>> by_size_;
  std::vector<MarkerShare> shares_;
  std::vector<std::pair<std::size_t, bool>> marker_verdicts_;
};

}  // namespace waymark
