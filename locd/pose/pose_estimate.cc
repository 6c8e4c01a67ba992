#include "locd/pose/pose_estimate.h"

#include <array>
#include <bit>
#include <chrono>

#include "locd/frames/frame_synchronizer.h"

namespace waymark {

std::string_view name_of(PoseReason reason) {
  constexpr std::array<std::string_view, kPoseReasons> kNames = {
      "NO_FRAMES",   "NO_MAP",         "NO_MARKERS",     "NO_SOLUTION", "TWO_POSES", "SIGMA",
      "FEW_MARKERS", "JUMP",           "CAMERA_MISSING", "NO_VELOCITY", "SKEW",      "UNSYNCED",
      "OUTLIERS",    "CAMERA_SUSPECT", "OVERLOAD",       "MISFIT",      "WRONG_MAP", "PROTECTION"};
  return kNames.at(static_cast<std::size_t>(std::countr_zero(bit(reason))));
}

void PoseEstimate::reset(PoseReason why) {
  lose_pose(why);
  sequence = 0;
  stamp = set_stamp = Stamp{0};
  cameras_expected = cameras_in_set = 0;
  markers_seen = 0;
  max_skew = Stamp{0};
  camera_offset.fill(Stamp{0});
  observations.clear();
  times = {};
}

void PoseEstimate::reset(PoseReason why, const FrameSetLease& set) {
  reset(why);
  sequence = set.sequence;
  stamp = set.mean_stamp();
  set_stamp = set.set_stamp();
  max_skew = set.max_skew();
  cameras_expected = set.expected;
  cameras_in_set = set.cameras;
  for (std::size_t c = 0; c < kMaxCameras; ++c) {
    if (set.has(c)) camera_offset[c] = set.frames[c].stamp() - stamp;
  }
}

void PoseEstimate::lose_pose(PoseReason why) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  status = PoseStatus::lost;
  reasons = bit(why);
  world_from_rig.rotation.coeffs().setConstant(kNaN);
  world_from_rig.translation.setConstant(kNaN);
  covariance.setConstant(kNaN);
  velocity.setConstant(kNaN);
  protection = {Eigen::Vector3d::Constant(kNaN), kNaN, kNaN, false};
  cameras_used = 0;
  markers_used = 0;
  observations_used = 0;
  outliers = 0;
  rms_px = kNaN;
}

Rigid3 PoseEstimate::world_from_rig_at(Stamp when) const {
  if (!velocity.allFinite()) return world_from_rig;
  return world_from_rig.plus(velocity * in_s(when - stamp));
}

}  // namespace waymark
