#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/camera/rig.h"
#include "core/map/marker_map.h"
#include "core/map/quarantine.h"
#include "locd/alert.h"
#include "locd/frames/frame_synchronizer.h"
#include "locd/pose/localizer_options.h"
#include "locd/pose/pose_estimate.h"

namespace waymark {

/// From frame sets to poses that can be trusted: finds markers in all cameras, solves for the rig
/// against the fixed map, judges the result, and watches map, cameras and images over time. One
/// thread calls it. After some sets it allocates nothing.
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

  /// Ignored and released markers at most; of more the last are left as they are.
  static constexpr std::size_t kMostOrders = 256;
  /// Has these markers (in rising order), and no others, take no part in anything from the next set
  /// on. No allocation.
  void ignore(std::span<const MarkerId> markers);
  /// Has the marker's quarantine end with the next set, whatever it was found to be; it may be
  /// found again. No allocation.
  void release(const MarkerId& marker);

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
