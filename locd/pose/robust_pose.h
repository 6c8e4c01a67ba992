#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/base/range.h"
#include "core/camera/rig.h"
#include "core/estimate/consider_pose.h"
#include "core/estimate/rig_pose_solver.h"
#include "locd/pose/corner_whitening.h"
#include "locd/pose/map_index.h"
#include "locd/pose/motion_filter.h"
#include "locd/pose/pose_covariance.h"
#include "locd/pose/set_observation.h"

namespace waymark {

/// A set's pose by all corners of all cameras.
struct PoseSolution {
  Rigid3 world_from_rig;
  Matrix6d covariance = Matrix6d::Zero();
  Matrix6d noise_covariance = Matrix6d::Zero();  ///< were calibration and map without errors
  double misfit = 0;      ///< χ² of all inliers and of what the calibration is known to
  int freedoms = 0;       ///< of it
  MotionEvidence motion;  ///< for the motion filter
  Vector6d velocity = Vector6d::Zero();  ///< that corners were moved by
  Matrix6d velocity_covariance = Matrix6d::Zero();
  bool ambiguous = false;
  bool rivals = false;  ///< three outliers or more agree on another pose
  int inliers = 0;
  int inlier_markers = 0;   ///< different ones
  int outlier_markers = 0;  ///< different ones that no inlier shows
};

/// Options of RobustPose.
struct RobustPoseOptions {
  double inlier_sigmas = kInlierSigmas;  ///< markers beyond are outliers (4–20)
  /// Where Tukey's loss, the last before inliers are told, is flat. (6–40 sigmas)
  double tukey_sigmas = 12.0;
  int seed_observations = 8;       ///< largest ones that seed, where they explain the set (1–64)
  int all_seed_observations = 32;  ///< the same where they do not (1–512)

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// One robust optimization over all corners of all cameras with the map's markers fixed (core's
/// Algorithm 1): starts from the prior and from fresh IPPE candidates, so that a wrong prior can't
/// hold it; Huber's loss comes near the optimum, Tukey's rejects outliers, and least squares
/// over the inliers with calibration errors as consider parameters has the full efficiency. Where
/// there are many outliers, the pose that they agree on is tried, too; where there are only
/// outliers, each camera's own.
///
/// Corners of other instants than the set's (free-running cameras, rolling shutters) are moved by
/// what the velocity does to them. The velocity, known beforehand to its covariance, is corrected
/// by the set itself, for cameras that don't agree about a moving rig are no outliers.
class RobustPose {
 public:
  /// The map must outlive it. `prior`: one like those that sets are solved with. The options are
  /// valid (checked).
  RobustPose(const Rig& rig, const MapIndex& map, const CalibrationPrior& prior,
             const RobustPoseOptions& options);

  /// nullopt when nothing explains what was seen. Marks inliers and writes residuals into
  /// `observations`; they stay whitened for hold_against and the watches.
  [[nodiscard]] std::optional<PoseSolution> solve(std::span<SetObservation> observations,
                                                  const std::optional<Rigid3>& predicted,
                                                  const VelocityPrior& velocity,
                                                  const KnownErrors& known);

  /// Residuals and verdicts of further observations, which took no part, at a solution.
  void hold_against(std::span<SetObservation> observations, const PoseSolution& solution,
                    const KnownErrors& known);

  /// The last solve's observations at its pose, in their order.
  [[nodiscard]] std::span<const ConsideredObservation> considered() const { return considered_; }

  /// Their least squares, to be asked for the pose without some of them.
  [[nodiscard]] ConsiderPose& consider() { return consider_; }

  [[nodiscard]] const RigPoseSolver& solver() const { return solver_; }

 private:
  void seed(std::span<SetObservation> observations, std::size_t count);
  enum class Which { all, inliers, outliers };
  void collect(std::span<const SetObservation> observations, Which which);
  int classify(std::span<SetObservation> observations, const Rigid3& pose) const;
  [[nodiscard]] std::optional<RigPoseEstimate> find_pose(std::span<SetObservation> observations,
                                                         const std::optional<Rigid3>& predicted);
  [[nodiscard]] bool polish(std::span<SetObservation> observations, Rigid3& pose,
                            const VelocityPrior& believed, const KnownErrors& known);
  [[nodiscard]] bool try_poses_of_cameras(std::span<SetObservation> observations, Rigid3& pose,
                                          const VelocityPrior& believed, const KnownErrors& known);
  [[nodiscard]] bool try_pose_of_outliers(std::span<SetObservation> observations, Rigid3& pose,
                                          const VelocityPrior& believed, const KnownErrors& known);
  /// An observation at a pose, whitened by its noise and its marker's own error; one of which a
  /// corner can't be projected fits nothing.
  [[nodiscard]] ConsideredObservation linearize(const SetObservation& observation,
                                                const Rigid3& pose, const VelocityPrior& velocity,
                                                const KnownErrors& known) const;
  /// From a pose nearby to the optimum with consider parameters; says anew who is an inlier.
  [[nodiscard]] bool refine(std::span<SetObservation> observations, const VelocityPrior& velocity,
                            const KnownErrors& known, Rigid3& pose);
  /// The same by one belief about calibrations.
  [[nodiscard]] bool refine_by(std::span<SetObservation> observations,
                               const VelocityPrior& velocity, const KnownErrors& known,
                               const CalibrationPrior& calibration, Rigid3& pose);
  [[nodiscard]] bool tell_inliers(std::span<SetObservation> observations);
  /// Whether three outliers or more, not many fewer than inliers, agree on another pose.
  [[nodiscard]] bool rivals_agree(std::span<SetObservation> observations,
                                  const PoseSolution& solution);
  void count_markers(std::span<const SetObservation> observations, PoseSolution& solution);

  const MapIndex& map_;
  int cameras_;
  RobustPoseOptions options_;
  RigPoseSolver solver_;
  CornerWhitening whitening_;
  ConsiderPose consider_;
  MapDependence dependence_;
  std::vector<ConsideredObservation> considered_;
  std::vector<FixedMarkerObservation> fixed_;
  std::vector<std::pair<double, std::size_t>> by_size_;
  std::vector<std::pair<std::size_t, bool>> marker_verdicts_;
};

}  // namespace waymark
