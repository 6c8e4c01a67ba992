#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/stamp.h"
#include "simulator/camera_motion.h"
#include "simulator/rig_library.h"
#include "simulator/scene.h"

namespace waymark::simulator {

/// One image to be taken.
struct Exposure {
  std::size_t position = 0;  ///< of the frame set along the way
  std::size_t camera = 0;    ///< index into the rig
  Stamp stamp{0};            ///< mid-exposure, of the middle row
};

/// When and where a rig takes its images along a scene's way: positions evenly spaced, passed at
/// constant speed, cameras at the same instant but for a skew.
class CapturePlan {
 public:
  /// `moving`: the rig passes the positions; else it stands at each of them while it takes images.
  /// `stamp_skew_sigma_s`: standard deviation of each exposure's shift (at most 3 sigma), which the
  /// stamp tells truly.
  CapturePlan(const Scene& scene, const SimulatedRig& rig, int positions, bool moving,
              double stamp_skew_sigma_s, std::uint64_t seed);

  /// By rising (position, camera).
  [[nodiscard]] const std::vector<Exposure>& exposures() const { return exposures_; }

  /// world_from_cam0 at an exposure's own instant.
  [[nodiscard]] Rigid3 world_from_cam0(const Exposure& exposure) const {
    return world_from_cam0_after(exposure, 0.0);
  }
  /// world_from_rig and world_from_cam at an exposure's own instant.
  [[nodiscard]] Rigid3 world_from_rig(const Exposure& exposure) const;
  [[nodiscard]] Rigid3 world_from_cam(const Exposure& exposure) const;

  /// How the exposure's camera moves about its instant.
  [[nodiscard]] CameraMotion motion(const Exposure& exposure) const;

 private:
  [[nodiscard]] Rigid3 world_from_cam0_after(const Exposure& exposure, double seconds) const;

  Rig rig_;
  Trajectory way_;
  double speed_mps_;
  double step_m_;
  bool moving_;
  std::vector<Exposure> exposures_;
};

}  // namespace waymark::simulator
