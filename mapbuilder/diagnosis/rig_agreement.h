#pragma once

#include <span>
#include <vector>

#include "mapbuilder/diagnosis/camera_tracks.h"

namespace waymark {

/// rig_from_cam of each camera, in the rig's order.
using Extrinsics = std::vector<Rigid3>;

/// Where cameras stood in one frame set less where the rig's pose puts them.
struct InstantAgreement {
  std::optional<Rigid3> world_from_rig;  ///< nullopt: fewer than one camera
  double cost = 0;                       ///< Σ ρ over cameras, sigmas²
  int cameras = 0;
};

/// Welsch's bounded loss c²(1 − exp(−s/c²)) of a squared misfit with six freedoms, c = 6: a camera
/// that is far off counts 36 sigmas², however far.
[[nodiscard]] double bounded_misfit(double squared_sigmas);

/// Squared misfit of a camera's place against where it is predicted, sigmas² of six freedoms.
[[nodiscard]] double squared_misfit(const TrackedPlace& place, const Rigid3& world_from_cam,
                                    double noise_scale);

/// The pose of the rig that most cameras agree on: started from each camera's own and refined by
/// iteratively reweighted least squares under the bounded loss. `without` (a camera's number) takes
/// no part; −1: all do. `noise_scale` multiplies every place's standard deviation.
[[nodiscard]] InstantAgreement agree(const CameraTracks::Instant& instant,
                                     const Extrinsics& rig_from_cam, double noise_scale,
                                     int without = -1);

}  // namespace waymark
