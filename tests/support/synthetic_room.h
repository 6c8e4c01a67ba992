#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/camera/rig.h"
#include "core/capture/detection.h"
#include "core/marker/marker_catalog.h"

namespace waymark::test {

/// A square room with markers on its walls and a rig that walks a circle inside.
struct RoomOptions {
  int markers = 40;
  int frame_sets = 60;
  int cameras = 3;        ///< looking outwards, evenly around the rig
  double noise_px = 0.0;  ///< Gaussian, per axis
  double room_m = 8.0;    ///< length of a wall
  double marker_m = 0.3;
  bool state_covariances = false;  ///< whether detections carry noise_px² I
  /// ≥ 0: the rig stands in the middle and turns about the vertical by so much in all; < 0: it
  /// walks.
  double turn_in_place_rad = -1.0;
  std::uint32_t seed = 1;
};

/// Detections with their truth.
struct SyntheticRoom {
  Rig rig;
  MarkerCatalog catalog;
  std::vector<Rigid3> world_from_marker;  ///< by number
  std::vector<Rigid3> world_from_rig;     ///< by frame set; stamps are 100 ms apart from 1 s on
  std::vector<ImageDetections> images;    ///< by rising (stamp, camera)
};

/// Exact projections plus seeded noise. Every marker that faces a camera within 75° and lies whole
/// in the image is seen.
[[nodiscard]] SyntheticRoom make_room(const RoomOptions& options);

/// Hangs another print into the room: every image taken when `there` says so detects it, exactly
/// where it can be seen.
void hang(SyntheticRoom& room, int number, const Rigid3& world_from_marker, double size_m,
          const std::function<bool(Stamp)>& there);

/// Three 1280×960 cameras of 90°, 120° apart (or as many as asked), none distortion; stated as
/// exact.
[[nodiscard]] Rig ring_rig(int cameras);

/// Stamp of frame set `index`.
[[nodiscard]] Stamp room_stamp(int index);

}  // namespace waymark::test
