#pragma once

#include <array>
#include <span>

#include "core/estimate/calibration_prior.h"
#include "core/estimate/rig_pose_solver.h"
#include "locd/pose/corner_noise.h"
#include "locd/pose/map_index.h"
#include "locd/pose/pose_covariance.h"
#include "locd/pose/set_observation.h"

namespace waymark {

/// What is known of errors before a set.
struct KnownErrors {
  NoiseSigmas noise_px{};        ///< added to what the detector states
  CalibrationPrior calibration;  ///< of cameras, sizes and the map's modes, as stated
  CalibrationPrior learnt;       ///< the same, with what sets have told since
};

/// How far each corner may be off while inliers are searched, where corners are taken for
/// independent: by noise, calibration, map and motion. Writes into the observations.
class CornerWhitening {
 public:
  /// Map and solver must outlive it.
  CornerWhitening(const MapIndex& map, const RigPoseSolver& solver) : map_(map), solver_(solver) {}

  /// Before a pose is known: the detector's and the model's errors, and about what an unknown
  /// motion does to a corner some metres away. Corners are as detected.
  void whiten_roughly(std::span<SetObservation> observations, const VelocityPrior& velocity,
                      const KnownErrors& known) const;
  /// With a pose: the map's, the calibration's and the velocity's errors too, as they show in each
  /// corner.
  void whiten(std::span<SetObservation> observations, const Rigid3& pose,
              const VelocityPrior& velocity, const KnownErrors& known) const;
  /// Moves detected corners to where they would be at the set's instant.
  void move_to_set_instant(std::span<SetObservation> observations, const Rigid3& pose,
                           const Vector6d& velocity) const;

 private:
  const MapIndex& map_;
  const RigPoseSolver& solver_;
};

}  // namespace waymark
