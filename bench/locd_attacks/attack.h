#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bench/simulated_drive.h"
#include "core/map/marker_map.h"
#include "locd/alert.h"
#include "simulator/random.h"
#include "simulator/scene.h"

namespace waymark::bench {

/// A rig in a building, and what locd is told of both. An attack makes the two differ.
struct World {
  simulator::Scene building;  ///< as it is
  Rig rig;                    ///< as it is
  MarkerMap told_map;
  Rig told_rig;
  DriveOptions drive;
  simulator::Random random{1};
  /// What is wrong: markers and cameras that may be named, everybody else is innocent.
  std::set<MarkerId> guilty_markers;
  std::set<int> guilty_cameras;
  std::vector<std::size_t> touched;  ///< markers of the building that an attack moves
  int touched_camera = 0;
};

/// One thing that goes wrong, from a set on, and maybe right again.
struct Attack {
  std::string name;
  std::function<void(World&)> prepare;  ///< before the first set
  /// Before each set: changes what is driven through. May be empty.
  std::function<void(World&, SimulatedDrive&, int set)> before_set;
  std::function<void(FrameSetLease&, int set)> of_set;  ///< changes a set's frames. May be empty
  int begins = 0;
  std::optional<int> ends;
  /// Alerts that name it rightly; empty: nothing is to be named.
  std::vector<AlertKind> causes;
  bool needs_cameras = false;  ///< not for a rig of one camera
};

/// On what cameras see: noise, old images; and none.
[[nodiscard]] std::vector<Attack> image_attacks();
/// On cameras: places, lenses, clocks, read-outs.
[[nodiscard]] std::vector<Attack> rig_attacks();
/// On markers and their map.
[[nodiscard]] std::vector<Attack> map_attacks();
/// Every row of the table.
[[nodiscard]] std::vector<Attack> all_attacks();

}  // namespace waymark::bench
