#include "locd/pose/pose_estimate.h"

#include <chrono>

namespace waymark {

void PoseEstimate::lose(PoseReason why) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  status = PoseStatus::lost;
  reasons = bit(why);
  world_from_rig.rotation.coeffs().setConstant(kNaN);
  world_from_rig.translation.setConstant(kNaN);
  covariance.setConstant(kNaN);
  velocity.setConstant(kNaN);
  cameras_used = 0;
  markers_used = 0;
  observations_used = 0;
  outliers = 0;
  rms_px = kNaN;
}

Rigid3 PoseEstimate::world_from_rig_at(Stamp when) const {
  if (!velocity.allFinite()) return world_from_rig;
  return world_from_rig.plus(velocity * std::chrono::duration<double>(when - stamp).count());
}

}  // namespace waymark
