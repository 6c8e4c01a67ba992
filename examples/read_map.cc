// Prints where the markers of a map are. Usage: read_map MAP
#include <core/map/map_file.h>

#include <cmath>
#include <cstdio>

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: read_map MAP\n", stderr);
    return 64;
  }
  const auto map = waymark::read_map_file(argv[1]);
  if (!map) {
    std::fprintf(stderr, "read_map: %s\n", map.error().message.c_str());
    return map.error().exit_code();
  }
  for (const waymark::SubMap& submap : map->submaps) {
    std::printf("sub-map of %zu markers, z is %sknown to be up\n", submap.markers.size(),
                submap.z_is_up ? "" : "not ");
    for (const waymark::MapMarker& marker : submap.markers) {
      const Eigen::Vector3d& x = marker.world_from_marker.translation;
      // The covariance's first three rows are the position's; NaN where nobody knows.
      const double sigma_m = std::sqrt(marker.covariance.diagonal().head<3>().maxCoeff());
      std::printf("%s: %.3f %.3f %.3f m, sigma %.1f mm, side %.3f m\n",
                  waymark::format_marker_id(marker.id, true).c_str(), x.x(), x.y(), x.z(),
                  1000 * sigma_m, marker.size_m);
    }
  }
  return 0;
}
