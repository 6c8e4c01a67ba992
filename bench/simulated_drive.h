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
  std::array<double, 3> late_s{};    ///< how much older than its stamp each camera's image is
  double readout_s = 0;  ///< of the rows of an image, all cameras; the stamp is the middle's
  double start_m = 0;    ///< of the way, where the drive begins
  std::uint64_t seed = 1;
};

/// A rig driving along a scene's way for ever, as frame sets of detections with their truth.
class SimulatedDrive {
 public:
  /// `rig` is the true one.
  SimulatedDrive(const simulator::Scene& building, const Rig& rig, const DriveOptions& options);

  /// Markers as they hang from now on.
  void rebuild(const simulator::Scene& building);

  /// The cameras as they stand and see from now on; as many as before. Where the rig is goes on to
  /// be told by the first one's first place.
  void mount(const Rig& rig) { rig_ = rig; }
  /// Noise of corners from now on; what detections state of it stays.
  void set_noise(double noise_px) { noise_px_ = noise_px; }

  /// The next set; its detections live until the call after.
  [[nodiscard]] FrameSetLease next();

  [[nodiscard]] Rigid3 world_from_rig(Stamp stamp) const;
  /// Where the rig is at the set of that number.
  [[nodiscard]] Rigid3 world_from_rig_at_set(int set) const;
  /// rad/s about the instant.
  [[nodiscard]] double turn_rate(Stamp stamp) const;
  /// Detections of the last set with their true ids.
  [[nodiscard]] const std::vector<ImageDetections>& images() const { return images_; }
  /// Markers of the building that the last set shows, by index; twice when two cameras see it.
  [[nodiscard]] const std::vector<std::size_t>& visible() const { return visible_; }

 private:
  [[nodiscard]] MarkerId misread(const MarkerId& truth);
  /// Corners as the rows that show them are read while the rig moves.
  void roll(std::size_t camera, Stamp middle, const simulator::PlacedMarker& marker,
            ImageCorners& corners) const;

  simulator::Scene building_;
  std::optional<simulator::Visibility> visibility_;
  Rig rig_;
  Rigid3 cam0_from_rig_;
  double noise_px_;
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
