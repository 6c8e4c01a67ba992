#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/camera/rig.h"
#include "core/map/marker_map.h"
#include "locd/frames/frame_synchronizer.h"
#include "simulator/random.h"
#include "simulator/scene.h"
#include "simulator/trajectory.h"
#include "simulator/visibility.h"

namespace waymark::bench {

/// How the rig drives and what its detector gets wrong.
struct DriveOptions {
  double speed_mps = 0.5;
  double period_s = 0.1;
  double noise_px = 0.1;             ///< per axis of each corner; stated as its covariance
  double miss_rate = 0;              ///< share of visible markers
  double false_rate = 0;             ///< share of detections with another id
  double drop_out_rate = 0;          ///< share of images
  std::array<double, 3> offset_s{};  ///< of each camera's exposure from the set's
  std::uint64_t seed = 1;
};

/// A rig driving along a scene's way for ever, as frame sets of detections with their truth.
class SimulatedDrive {
 public:
  /// `rig` is the true one.
  SimulatedDrive(const simulator::Scene& building, const Rig& rig, const DriveOptions& options);

  /// Markers as they hang from now on.
  void rebuild(const simulator::Scene& building);

  /// The next set; its detections live until the call after.
  [[nodiscard]] FrameSetLease next();

  [[nodiscard]] Rigid3 world_from_rig(Stamp stamp) const;
  /// rad/s about the instant.
  [[nodiscard]] double turn_rate(Stamp stamp) const;
  /// Detections of the last set with their true ids.
  [[nodiscard]] const std::vector<ImageDetections>& images() const { return images_; }
  /// Markers of the building that the last set shows, by index; twice when two cameras see it.
  [[nodiscard]] const std::vector<std::size_t>& visible() const { return visible_; }

 private:
  [[nodiscard]] MarkerId misread(const MarkerId& truth);

  simulator::Scene building_;
  std::optional<simulator::Visibility> visibility_;
  Rig rig_;
  DriveOptions options_;
  simulator::Trajectory way_;
  simulator::Random random_;
  std::uint64_t sets_ = 0;
  std::vector<ImageDetections> images_;
  std::vector<std::size_t> visible_;
};

/// The map that a scene's markers are, without any uncertainty.
[[nodiscard]] MarkerMap true_map(const simulator::Scene& scene);

}  // namespace waymark::bench
