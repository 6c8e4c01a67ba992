#pragma once

#include <memory>
#include <span>

#include "core/camera/rig.h"
#include "core/map/marker_map.h"
#include "core/map/quarantine.h"
#include "locd/alert.h"
#include "locd/frames/frame_synchronizer.h"
#include "locd/pose/pose_estimate.h"
#include "locd/pose/pose_gate.h"

namespace waymark {

/// How frame sets become poses.
struct LocalizerOptions {
  GateOptions gate;
  /// Older poses say nothing of the next. (0.05–10 s)
  double prior_max_age_s = 0.5;
  /// Exposures farther apart need the rig's velocity to be put together; on a triggered rig they
  /// must not occur. (0–100 ms)
  Stamp negligible_skew = std::chrono::microseconds(1000);
  bool triggered = false;     ///< the rig's cameras expose together: skew is a fault
  int detection_threads = 0;  ///< 0: one per camera, at most as many as there are processors
};

/// From frame sets to poses that can be trusted: finds markers in all cameras, solves for the rig
/// against the fixed map, judges the result, and watches map, cameras and images over time. One
/// thread calls it. After some sets it allocates nothing but what the detector's libraries do.
/// Reloading: make another one aside and swap; it knows no prior, velocity or statistics.
class Localizer {
 public:
  /// Copies what it needs of rig and map. The rig has extrinsics or one camera, at most
  /// kMaxCameras; the map has a marker (checked).
  Localizer(const Rig& rig, const MarkerMap& map, const LocalizerOptions& options);
  ~Localizer();
  Localizer(const Localizer&) = delete;
  Localizer& operator=(const Localizer&) = delete;

  /// The pose of the set. Never fails: the status says what it is worth.
  void localize(const FrameSetLease& set, PoseEstimate& estimate);

  /// What began or ended with the last set.
  [[nodiscard]] std::span<const Alert> alerts() const;

  /// Discards prior and velocity (a clock's step, a gap); statistics stay.
  void forget_motion();

  /// Markers that the map watch distrusts, to be kept across restarts; changed() since the last
  /// call of quarantine().
  [[nodiscard]] bool quarantine_changed() const;
  [[nodiscard]] std::vector<QuarantinedMarker> quarantine();
  /// Takes over what a former run knew; ids that the map lacks are passed over.
  void restore_quarantine(std::span<const QuarantinedMarker> markers);

  /// Cameras whose images can't be used now: frozen, dark, saturated, obscured.
  [[nodiscard]] CameraMask unhealthy_cameras() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace waymark
