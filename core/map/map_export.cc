#include "core/map/map_export.h"

#include <iterator>

#include "core/geometry/tum.h"
#include "core/marker/marker_geometry.h"

namespace waymark {

std::string format_submap_tum(const SubMap& submap, bool with_family) {
  std::vector<TumPose> poses;
  for (const MapMarker& marker : submap.markers) {
    poses.push_back({format_marker_id(marker.id, with_family), marker.world_from_marker});
  }
  return format_tum(poses);
}

namespace {

/// Six standard deviations, or as many empty fields.
std::string sigma_fields(const MapMarker& marker) {
  if (!marker.covariance_known()) return ",,,,,";
  const Vector6d sigma = marker.covariance.diagonal().cwiseMax(0).cwiseSqrt();
  return fmt::format("{:.3g},{:.3g},{:.3g},{:.3g},{:.3g},{:.3g}", sigma[0], sigma[1], sigma[2],
                     sigma[3], sigma[4], sigma[5]);
}

}  // namespace

std::string format_submap_csv(const SubMap& submap, bool with_family) {
  std::string text =
      "id,family,size_m,stated_size_m,x_m,y_m,z_m,qx,qy,qz,qw,sigma_x_m,sigma_y_m,sigma_z_m,"
      "sigma_rx_rad,sigma_ry_rad,sigma_rz_rad,observations,rejected,rms_px,verified\n";
  for (const MapMarker& marker : submap.markers) {
    const Eigen::Vector3d& t = marker.world_from_marker.translation;
    const Eigen::Quaterniond& q = marker.world_from_marker.rotation;
    fmt::format_to(std::back_inserter(text),
                   "{},{},{},{},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},"
                   "{},{},{},{:.4f},{}\n",
                   format_marker_id(marker.id, with_family), name_of(marker.id.family),
                   marker.size_m, marker.stated_size_m, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(),
                   q.w(), sigma_fields(marker), marker.observations, marker.rejected, marker.rms_px,
                   marker.verified ? 1 : 0);
  }
  return text;
}

std::string format_submap_ply(const SubMap& submap) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\n"
      "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
      "element face {}\nproperty list uchar int vertex_indices\n"
      "property int id\nproperty uchar verified\nend_header\n",
      4 * submap.markers.size(), submap.markers.size());
  for (const MapMarker& marker : submap.markers) {
    for (const Eigen::Vector3d& corner : marker_corners(marker.size_m)) {
      const Eigen::Vector3d x = marker.world_from_marker * corner;
      fmt::format_to(std::back_inserter(text), "{:.9f} {:.9f} {:.9f}\n", x.x(), x.y(), x.z());
    }
  }
  for (std::size_t i = 0; i < submap.markers.size(); ++i) {
    // Corners are stored clockwise as seen from the front.
    fmt::format_to(std::back_inserter(text), "4 {} {} {} {} {} {}\n", 4 * i, 4 * i + 3, 4 * i + 2,
                   4 * i + 1, submap.markers[i].id.number, submap.markers[i].verified ? 1 : 0);
  }
  return text;
}

}  // namespace waymark
