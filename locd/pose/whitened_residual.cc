#include "locd/pose/whitened_residual.h"

namespace waymark {

std::optional<WhitenedResidual> whitened_residual(const SetObservation& observation,
                                                  const MapIndex& map, const RigPoseSolver& solver,
                                                  const Rigid3& world_from_rig) {
  const MarkerObservation& o = observation.observation;
  const auto corners =
      linearize_corners(o, solver.geometry(o.camera, world_from_rig,
                                           map.marker(observation.map_index).world_from_marker));
  if (!corners) return std::nullopt;
  WhitenedResidual whitened;
  for (std::size_t i = 0; i < 4; ++i) {
    const LinearizedCorner& corner = (*corners)[i];
    const auto row = static_cast<Eigen::Index>(2 * i);
    whitened.residual.segment<2>(row) = corner.residual;
    whitened.by_rig.middleRows<2>(row) = o.whitening[i] * corner.jacobians.d_rig;
    whitened.by_marker.middleRows<2>(row) = o.whitening[i] * corner.jacobians.d_marker;
  }
  return whitened;
}

}  // namespace waymark
