#include "locd/pose/whitened_residual.h"

#include "core/estimate/corner_residual.h"

namespace waymark {

std::optional<WhitenedResidual> whitened_residual(const SetObservation& observation,
                                                  const MapIndex& map, const RigPoseSolver& solver,
                                                  const Rigid3& world_from_rig) {
  const auto camera = static_cast<std::size_t>(observation.observation.camera);
  const MapMarker& marker = map.marker(observation.map_index);
  const CornerChain chain(solver.model(camera), solver.cam_from_rig(camera), world_from_rig,
                          marker.world_from_marker);
  const auto corners = marker_corners(marker.size_m);
  WhitenedResidual whitened;
  for (std::size_t i = 0; i < 4; ++i) {
    CornerJacobians jacobians;
    const auto residual =
        corner_residual(chain, corners[i], observation.observation.corners_px[i], &jacobians);
    if (!residual) return std::nullopt;
    const auto row = static_cast<Eigen::Index>(2 * i);
    const Eigen::Matrix2d& w = observation.observation.whitening[i];
    whitened.residual.segment<2>(row) = w * *residual;
    whitened.by_rig.middleRows<2>(row) = w * jacobians.d_rig;
    whitened.by_marker.middleRows<2>(row) = w * jacobians.d_marker;
  }
  return whitened;
}

}  // namespace waymark
