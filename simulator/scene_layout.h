#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"
#include "simulator/scene.h"

namespace waymark::simulator {

/// Rows and columns of markers on every surface whose name matches a pattern.
struct MarkerGrid {
  std::string on;               ///< surface name; `*` stands for any characters: "shelf*.south"
  std::vector<double> rows_m;   ///< heights of the marker centres above the surface's lower edge
  int columns = 1;              ///< evenly spaced across the surface, between the margins
  double margin_left_m = 0.5;   ///< free at the left edge
  double margin_right_m = 0.5;  ///< free at the right edge
  double stagger_m = 0;         ///< every other row is moved right by this
  double jitter_m = 0.05;       ///< ± uniform, across and up
  double roll_sigma_deg = 3;    ///< nobody hangs them straight
  double tilt_sigma_deg = 0.7;  ///< nor are walls flat
};

/// The six inner faces of a room: room.floor, room.ceiling, room.south (y = 0), room.east,
/// room.north, room.west.
[[nodiscard]] std::vector<Surface> room_faces(const Eigen::Vector3d& size_m);

/// The five visible faces of a box that stands on the floor: .south .east .north .west .top;
/// .bottom besides when it hangs.
[[nodiscard]] std::vector<Surface> box_faces(const Box& box);

/// Both faces of a free-standing wall: .left and .right of the way from → to.
[[nodiscard]] std::vector<Surface> wall_faces(const std::string& name,
                                              const Eigen::Vector3d& from_m,
                                              const Eigen::Vector3d& to_m, double top_m);

/// Hangs markers on the scene's surfaces, grid after grid, surface after surface, row after row,
/// and gives them `ids` in an order shuffled by the scene's seed (so that sizes mix). bad_data when
/// a pattern matches no surface, a marker does not fit its surface, two overlap, an id has no size,
/// or the number of places differs from the number of ids.
[[nodiscard]] Status place_markers(Scene& scene, const std::vector<MarkerGrid>& grids,
                                   std::vector<MarkerId> ids);

}  // namespace waymark::simulator
