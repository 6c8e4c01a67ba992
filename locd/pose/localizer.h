#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/base/range.h"
#include "core/camera/rig.h"
#include "core/map/marker_map.h"
#include "core/map/quarantine.h"
#include "locd/alert.h"
#include "locd/frames/frame_synchronizer.h"
#include "locd/frames/skew_watch.h"
#include "locd/pose/motion_filter.h"
#include "locd/pose/pose_estimate.h"
#include "locd/pose/pose_gate.h"

namespace waymark {

/// How frame sets become poses.
struct LocalizerOptions {
  GateOptions gate;
  double prior_max_age_s = 0.5;  ///< older poses predict nothing
  /// Exposures farther apart need the rig's velocity to be put together; on a triggered rig they
  /// must not occur.
  Stamp negligible_skew = std::chrono::microseconds(1000);
  bool triggered = false;  ///< the rig's cameras expose together: skew is a fault
  /// Cameras that ran before the program did: see ImageHealthOptions. A capture's first images are
  /// as good as any.
  bool doubt_first_images = false;
  int detection_threads = 0;  ///< 0: one per camera, at most as many as there are processors
  /// Called by each detection worker when it begins: its name, its priority. Empty: nothing.
  std::function<void()> begin_worker;

  static constexpr Range kPriorMaxAge_s = MotionOptions::kMaxAge_s;
  static constexpr Range kNegligibleSkew_ms = SkewWatchOptions::kMost_ms;
  static constexpr Range kDetectionThreads{0, kMaxCameras};
  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// From frame sets to poses that can be trusted: finds markers in all cameras, solves for the rig
/// against the fixed map, judges the result, and watches map, cameras and images over time. One
/// thread calls it. After some sets it allocates nothing but what the detector's libraries do.
/// Reloading: make another one aside and swap; it knows no prior, velocity or statistics, and no
/// images but by remember_images_of().
class Localizer {
 public:
  /// Copies what it needs of rig and map. The rig has extrinsics or one camera, at most
  /// kMaxCameras; the map has a marker; the options are valid (checked). Markers of families that
  /// are not found in images are used only where detections come with the frames.
  Localizer(const Rig& rig, const MarkerMap& map, const LocalizerOptions& options);
  ~Localizer();
  Localizer(const Localizer&) = delete;
  Localizer& operator=(const Localizer&) = delete;

  /// The pose of the set. Never fails: the status says what it is worth.
  void localize(const FrameSetLease& set, PoseEstimate& estimate);

  /// What began or ended with the last set.
  [[nodiscard]] std::span<const Alert> alerts() const;

  /// Discards prior and velocity, for the vehicle may have been moved unseen (the machine slept);
  /// statistics stay.
  void forget_motion();

  /// Takes over from the localizer that this one replaces which images the cameras gave: one that
  /// comes again after a reload is no new one. No allocation.
  void remember_images_of(const Localizer& before);

  /// Whether the quarantined markers, which are to be kept across restarts, are others than at the
  /// last call of list_quarantine().
  [[nodiscard]] bool quarantine_changed() const;
  /// Puts them into `list`, by rising id; never more than most_quarantined().
  void list_quarantine(std::vector<QuarantinedMarker>& list);
  [[nodiscard]] std::size_t most_quarantined() const;
  /// Takes over what a former run knew; ids that the map lacks are passed over.
  void restore_quarantine(std::span<const QuarantinedMarker> markers);

  /// Cameras whose images can't be used now: frozen, stale, dark, saturated, obscured.
  [[nodiscard]] CameraMask unhealthy_cameras() const;
  /// Cameras whose frame in the last set was left out, and why: unhealthy (or given before) or
  /// unsearched; none for other reasons.
  [[nodiscard]] CameraMask left_out(DropReason why) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace waymark
