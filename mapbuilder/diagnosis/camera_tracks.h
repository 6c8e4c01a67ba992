#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/camera/camera_model.h"
#include "core/geometry/rigid3.h"
#include "core/geometry/stamp.h"
#include "mapbuilder/diagnosis/mono_build.h"

namespace waymark {

/// Where a camera stood in one frame set, as its own image tells.
struct TrackedPlace {
  Rigid3 world_from_cam;
  Matrix6d information;  ///< inverse covariance of world_from_cam's tangent (1/m², 1/rad²)
};

/// The places of a rig's cameras in one world, each told by its own images alone: what remains
/// true whatever the rig file and the clocks say.
struct CameraTracks {
  struct Instant {
    Stamp stamp{0};                                   ///< of the frame set
    std::vector<std::optional<TrackedPlace>> places;  ///< per camera of the rig
  };
  std::vector<std::string> cameras;  ///< names, in the rig's order
  std::vector<CameraModel> lenses;   ///< by which places were told; empty: those stated
  std::vector<Instant> instants;     ///< by rising stamp
};

/// The tracks of a capture's cameras by its images, localized each on its own, with the `rig` that
/// they were localized by. Instants are the capture's frame sets; ambiguous images have no place.
[[nodiscard]] CameraTracks tracks_of(const LocalizedImages& localized, const Rig& rig,
                                     Stamp sync_tolerance);

}  // namespace waymark
