#include "locd/pose/pose_table.h"

#include <fmt/format.h>

#include <iterator>

namespace waymark {

std::string pose_table_head() {
  std::string head = "set_ns,stamp_ns,status,reasons,x,y,z,qx,qy,qz,qw";
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) head += fmt::format(",c{}{}", i, j);
  }
  for (int i = 0; i < 6; ++i) head += fmt::format(",v{}", i);
  return head +
         ",cameras_in_set,cameras_used,markers_seen,markers_used,observations_used,outliers,rms_px,"
         "max_skew_us\n";
}

void append_pose_table_row(const PoseEstimate& estimate, Stamp shift, std::string& text) {
  auto out = std::back_inserter(text);
  const Eigen::Vector3d& t = estimate.world_from_rig.translation;
  const Eigen::Quaterniond& q = estimate.world_from_rig.rotation;
  fmt::format_to(out, "{},{},{},{},{:.9f},{:.9f},{:.9f},{:.12f},{:.12f},{:.12f},{:.12f}",
                 (estimate.set_stamp - shift).count(), (estimate.stamp - shift).count(),
                 static_cast<int>(estimate.status), estimate.reasons, t.x(), t.y(), t.z(), q.x(),
                 q.y(), q.z(), q.w());
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) fmt::format_to(out, ",{:.6e}", estimate.covariance(i, j));
  }
  for (int i = 0; i < 6; ++i) fmt::format_to(out, ",{:.6f}", estimate.velocity[i]);
  fmt::format_to(out, ",{},{},{},{},{},{},{:.4f},{}\n", estimate.cameras_in_set,
                 estimate.cameras_used, estimate.markers_seen, estimate.markers_used,
                 estimate.observations_used, estimate.outliers, estimate.rms_px,
                 estimate.max_skew.count() / 1000);
}

}  // namespace waymark
