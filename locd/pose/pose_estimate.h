#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "core/capture/detection.h"
#include "core/geometry/rigid3.h"
#include "core/geometry/stamp.h"
#include "core/marker/marker_geometry.h"
#include "core/marker/marker_id.h"
#include "locd/camera_mask.h"

namespace waymark {

struct FrameSetLease;

/// Observations of one frame set that are used and reported; of more, the largest in the image.
inline constexpr std::size_t kMaxObservations = 512;

/// What a pose is worth. Numbers are those of pose_t: never renumber.
enum class PoseStatus : std::int8_t {
  ok = 0,         ///< right within its covariance, which is within the limits
  degraded = 1,   ///< the best estimate there is; the reason bits say what is wrong with it
  ambiguous = 2,  ///< another pose explains the data too
  lost = 3,       ///< there is no pose: every estimate is NaN
};

/// Why a pose is not OK: bits of PoseEstimate::reasons and pose_t. Only append.
enum class PoseReason : std::uint32_t {
  no_frames = 1U << 0,        ///< lost: no camera delivers
  no_map = 1U << 1,           ///< lost: there is no map
  no_markers = 1U << 2,       ///< lost: no marker of the map was seen, or only quarantined ones
  no_solution = 1U << 3,      ///< lost: no pose explains what was seen
  ambiguous = 1U << 4,        ///< the runner-up explains the data too
  sigma = 1U << 5,            ///< own 3 sigma beyond the limits
  few_markers = 1U << 6,      ///< one marker, and no prior that agrees
  jump = 1U << 7,             ///< farther from the last poses than v_max and w_max allow
  camera_missing = 1U << 8,   ///< a camera of the rig is not in the set
  no_velocity = 1U << 9,      ///< cameras exposed at different times, velocity is not known yet
  skew = 1U << 10,            ///< a triggered rig's cameras did not expose together
  unsynced = 1U << 11,        ///< a frame's stamp is its arrival
  outliers = 1U << 12,        ///< too many markers disagree, or too few can check one another
  camera_suspect = 1U << 13,  ///< a camera's extrinsics or place among the cameras are in doubt
  overload = 1U << 14,        ///< lost: frames come faster than they can be localized
  misfit = 1U << 15,          ///< what is seen contradicts itself; what is wrong is not known yet
  wrong_map = 1U << 16,       ///< markers don't hang where the map says, all over
  protection = 1U << 17,      ///< protection levels beyond the limits
};
using ReasonBits = std::uint32_t;
[[nodiscard]] constexpr ReasonBits bit(PoseReason reason) {
  return static_cast<ReasonBits>(reason);
}
/// How many there are: bits 0 to kPoseReasons − 1.
inline constexpr std::size_t kPoseReasons = 18;
/// "NO_FRAMES", …: the constant of pose_t.
[[nodiscard]] std::string_view name_of(PoseReason reason);

/// What was thought of one detection.
enum class ObservationVerdict : std::int8_t {
  inlier = 0,       ///< carries the pose
  outlier = 1,      ///< of a mapped marker, and does not fit
  quarantined = 2,  ///< its marker or camera is suspect: looked at, not used
  unknown = 3,      ///< its marker is not in the map
  repeated = 4,     ///< its id was found twice in one image: not used
  unused = 5,       ///< there is no pose to hold it against
  ignored = 6,      ///< somebody has told locd to leave its marker out
  beyond = 7,       ///< seen where its camera's calibration says nothing: not used
};

/// One detection and its residual, for the detections channel.
struct ObservedMarker {
  MarkerId marker;
  std::int16_t camera = 0;
  ObservationVerdict verdict = ObservationVerdict::unused;
  ImageCorners corners_px;                                   ///< as detected
  std::optional<CornerCovariances> covariances;              ///< as the detector states them
  double rms_px = std::numeric_limits<double>::quiet_NaN();  ///< of its corners' residual norms
  double sigmas_squared = std::numeric_limits<double>::quiet_NaN();  ///< 8 degrees of freedom
};

/// How long the stages of one set took.
struct StageTimes {
  Stamp detect{0};  ///< all cameras, from first to last
  Stamp solve{0};   ///< detections to pose
  Stamp watch{0};   ///< gate, map watch
};

/// Bounds that a pose's error exceeds seldom (ProtectionLevels::kRisk) while nothing is wrong, or
/// any one marker or, of several, any one camera is, by whatever amount. World axes.
struct Protection {
  Eigen::Vector3d axis_m;   ///< of the protected point, along each axis
  double horizontal_m = 0;  ///< of it, in the plane of x and y
  double rotation_rad = 0;
  bool of_cameras = false;  ///< whether a camera may be wrong, too

  [[nodiscard]] bool finite() const {
    return axis_m.allFinite() && std::isfinite(horizontal_m) && std::isfinite(rotation_rad);
  }
  /// Nothing is bounded.
  [[nodiscard]] static Protection none(bool of_cameras) {
    constexpr double kAny = std::numeric_limits<double>::infinity();
    return {Eigen::Vector3d::Constant(kAny), kAny, kAny, of_cameras};
  }
};

/// The result of one frame set: all that a pose message says. One is made at start and filled again
/// and again, without allocation.
struct PoseEstimate {
  PoseEstimate() { observations.reserve(kMaxObservations); }

  std::uint64_t sequence = 0;  ///< of the frame set, from 0
  Stamp stamp{0};  ///< that the pose is of: mean mid-exposure of the frames used, CLOCK_MONOTONIC
  Stamp set_stamp{0};  ///< of the lowest-numbered camera's frame

  PoseStatus status = PoseStatus::lost;
  ReasonBits reasons = 0;
  Rigid3 world_from_rig;  ///< NaN when lost
  Matrix6d covariance;    ///< Rigid3's tangent: m, rad, world axes; NaN when lost
  Protection protection;  ///< NaN when lost
  Vector6d velocity;      ///< m/s, rad/s, world axes; NaN when not known

  int resets = 0;  ///< how often the rig was found anew since the start: a step there is no motion

  CameraMask cameras_expected = 0;  ///< of the rig
  CameraMask cameras_in_set = 0;    ///< delivered a frame
  CameraMask cameras_used = 0;      ///< see at least one inlier
  int markers_seen = 0;             ///< different markers detected, mapped or not
  int markers_used = 0;             ///< different markers with an inlier
  int observations_used = 0;
  int outliers = 0;   ///< observations of mapped, unquarantined markers that don't fit
  double rms_px = 0;  ///< sqrt(mean squared residual norm) over inliers' corners; NaN: none
  Stamp max_skew{0};  ///< between the frames of the set
  std::array<Stamp, kMaxCameras> camera_offset{};  ///< frame's stamp less `stamp`; 0 when absent

  std::vector<ObservedMarker> observations;  ///< at most kMaxObservations, by camera then marker
  StageTimes times;

  [[nodiscard]] bool has(PoseReason reason) const { return (reasons & bit(reason)) != 0; }
  [[nodiscard]] bool has_pose() const { return status != PoseStatus::lost; }

  /// Empties the estimate: LOST for `why`, every number of the pose NaN,
  /// stamps and counts 0, no observations.
  void reset(PoseReason why);
  /// The same of a frame set: with its number, stamps and cameras.
  void reset(PoseReason why, const FrameSetLease& set);
  /// Takes the pose away, LOST for `why`; what was observed stays.
  void lose_pose(PoseReason why);
  /// The pose moved to `when` by the velocity, where that is known.
  [[nodiscard]] Rigid3 world_from_rig_at(Stamp when) const;
};

}  // namespace waymark
