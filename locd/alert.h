#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "core/camera/rig.h"
#include "core/geometry/stamp.h"
#include "core/marker/marker_id.h"

namespace waymark {

/// What is wrong for longer than a frame set. Numbers are those of alert_t: only append.
enum class AlertKind : std::int8_t {
  marker_moved = 0,       ///< MOVED: a mapped marker hangs elsewhere; quarantined
  marker_unknown = 1,     ///< UNKNOWN: a marker hangs there that the map does not hold
  image_frozen = 2,       ///< FROZEN: the camera repeats one image
  image_dark = 3,         ///< DARK
  image_saturated = 4,    ///< SATURATED
  image_obscured = 5,     ///< OBSCURED: nothing but a blur before the lens
  extrinsics_off = 6,     ///< EXTRINSICS: a camera does not stand where the rig file says
  cameras_swapped = 7,    ///< SWAP: two cameras are in each other's place
  camera_missing = 8,     ///< MISSING: a camera delivers nothing
  stamps_unsynced = 9,    ///< UNSYNCED: a camera's stamps can't be believed; arrival is used
  stamps_skewed = 10,     ///< SKEW: a triggered rig's cameras do not expose together
  settings_changed = 11,  ///< SETTINGS: another program sets exposure, gain or focus of a camera
  image_stale = 12,       ///< STALE: the camera gives images that it gave before
  image_unsearched = 13,  ///< UNSEARCHED: the library that finds markers fails on its images
  lens_off = 14,          ///< INTRINSICS: a camera's lens is not what the rig file says
  readout_off = 15,       ///< READOUT: a camera's rows are not read in the time that is stated
  corners_noisy = 16,     ///< NOISE: corners are ten times noisier than usual
  map_wrong = 17,         ///< WRONG_MAP: markers hang where no map that is loaded says
  marker_riding = 18,     ///< RIDING: a marker moves along with the vehicle
};
inline constexpr std::size_t kAlertKinds = 19;

/// "MOVED", "FROZEN", …
[[nodiscard]] std::string_view name_of(AlertKind kind);

/// Something began to be wrong, or ended. Plain data, so that raising one allocates nothing.
struct Alert {
  AlertKind kind = AlertKind::marker_moved;
  bool raised = true;       ///< false: it is over
  bool map_loaded = false;  ///< it is over because a map was loaded: what it told of is judged anew
  Stamp stamp{0};           ///< of the frame set that told, CLOCK_MONOTONIC
  int camera = -1;          ///< index in the rig; −1: none in particular
  int other_camera = -1;
  std::optional<MarkerId> marker;
  /// How far off, where that is a length or an angle: a marker's or a camera's offset.
  double offset_m = std::numeric_limits<double>::quiet_NaN();
  double offset_rad = std::numeric_limits<double>::quiet_NaN();
  /// What it should be instead, less what is stated, and how sure that is: of a lens the share of
  /// its focal length, of a clock or a read-out s; of noise the corners' sigma (px).
  double value = std::numeric_limits<double>::quiet_NaN();
  double sigma = std::numeric_limits<double>::quiet_NaN();
};

/// Whether two alerts are of the same kind and of the same marker, camera or pair of cameras: what
/// one raises the other ends.
[[nodiscard]] bool same_subject(const Alert& a, const Alert& b);

/// Whom it concerns: the marker's id, else the camera's name, else nothing.
[[nodiscard]] std::string subject_of(const Alert& alert, const Rig& rig, bool several_families);

/// What the log counts alerts under: "MOVED 12", "MOVED is over 12".
[[nodiscard]] std::string log_key(const Alert& alert, const Rig& rig, bool several_families);

/// One line for people, with what to do: "MOVED: marker 12 hangs 0.31 m from where the map says;
/// …"; "MOVED is over: marker 12 hangs where the map says; it is used again".
[[nodiscard]] std::string alert_text(const Alert& alert, const Rig& rig, bool several_families);

}  // namespace waymark
