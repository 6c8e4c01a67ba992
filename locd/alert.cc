#include "locd/alert.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace waymark {
namespace {

constexpr std::array<std::string_view, kAlertKinds> kNames = {
    "MOVED",      "UNKNOWN", "FROZEN",   "DARK",      "SATURATED", "OBSCURED", "EXTRINSICS",
    "SWAP",       "MISSING", "UNSYNCED", "SKEW",      "SETTINGS",  "STALE",    "UNSEARCHED",
    "INTRINSICS", "READOUT", "NOISE",    "WRONG_MAP", "RIDING"};

std::string camera_name(const Rig& rig, int camera) {
  if (camera < 0 || static_cast<std::size_t>(camera) >= rig.cameras.size()) return "the rig";
  return rig.cameras[static_cast<std::size_t>(camera)].name;
}

/// "0.310 m and 2.0 deg from", or "elsewhere than" where it is not known how far.
std::string away_from(const Alert& alert) {
  if (!std::isfinite(alert.offset_m) || !std::isfinite(alert.offset_rad)) return "elsewhere than";
  const double offset_deg = alert.offset_rad * 180.0 / std::numbers::pi;
  return fmt::format("{:.3f} m and {:.1f} deg from", alert.offset_m, offset_deg);
}

/// "-20.1 ms (± 0.3)", or "some ms" where it is not known.
std::string figure(double value, double sigma, const char* unit) {
  if (!std::isfinite(value) || !std::isfinite(sigma)) return fmt::format("some {}", unit);
  return fmt::format("{:+.2f} {} (± {:.2f})", value, unit, sigma);
}

/// What is wrong, and what to do.
std::string raised_text(const Alert& alert, const std::string& marker, const std::string& camera,
                        const std::string& other) {
  switch (alert.kind) {
    case AlertKind::marker_moved:
      return fmt::format(
          "marker {} hangs {} where the map says; it is not used any more; put it back, or map "
          "anew",
          marker, away_from(alert));
    case AlertKind::marker_unknown:
      return fmt::format("marker {} is not in the map; map anew to use it", marker);
    case AlertKind::image_frozen:
      return fmt::format("{} repeats one image; it is not used; restart the camera", camera);
    case AlertKind::image_stale:
      return fmt::format(
          "{} gives images that it gave before; they are not used; restart the camera", camera);
    case AlertKind::image_unsearched:
      return fmt::format(
          "{}'s images can't be searched for markers: each fails; they are not used; "
          "please report it, with a recording",
          camera);
    case AlertKind::image_dark:
      return fmt::format("{} sees nothing but black; is its lens covered, the light off?", camera);
    case AlertKind::image_saturated:
      return fmt::format("{} sees nothing but white; lower exposure or gain", camera);
    case AlertKind::image_obscured:
      return fmt::format("{} sees nothing but a blur; clean its lens", camera);
    case AlertKind::extrinsics_off:
      return fmt::format("{} stands {} where the rig file says; calibrate the rig", camera,
                         away_from(alert));
    case AlertKind::cameras_swapped:
      return fmt::format("{} and {} are in each other's place; swap their plugs or serials", camera,
                         other);
    case AlertKind::camera_missing:
      return fmt::format("{} delivers no frames; check its cable", camera);
    case AlertKind::stamps_unsynced:
      return fmt::format("{}'s stamps can't be believed; arrival times are used", camera);
    case AlertKind::stamps_skewed:
      if (alert.camera < 0) return "the cameras do not expose together; check the trigger";
      return fmt::format(
          "{}'s images were taken {} after what their stamps say; it is not used where others "
          "suffice; set stamp_delay_us, or look for what delays them",
          camera, figure(1e3 * alert.value, 1e3 * alert.sigma, "ms"));
    case AlertKind::lens_off:
      return fmt::format(
          "{}'s lens is not what the rig file says: focal length by {}, or its distortion; it is "
          "not used where others suffice; was it turned, or refocused? calibrate it",
          camera, figure(100 * alert.value, 100 * alert.sigma, "%"));
    case AlertKind::readout_off:
      return fmt::format(
          "{}'s rows are read {} longer than readout_us says; it is not used where others suffice; "
          "state it in the rig file",
          camera, figure(1e3 * alert.value, 1e3 * alert.sigma, "ms"));
    case AlertKind::corners_noisy:
      return fmt::format(
          "{}'s corners are ten times less certain than usual; sigmas follow; dirt, vibration, a "
          "lens out of focus, too little light?",
          camera);
    case AlertKind::map_wrong:
      return "markers do not hang where the map says, all over; is it the map of this floor?";
    case AlertKind::marker_riding:
      return fmt::format(
          "marker {} moves along with the vehicle; it is not used; cover it, or ignore its id",
          marker);
    case AlertKind::settings_changed:
      return fmt::format(
          "another program changes settings of {}; they are set again, stamps are approximate "
          "until "
          "then; end that program (fuser -v /dev/video*)",
          camera);
  }
  return "";
}

/// How it is now.
std::string over_text(const Alert& alert, const std::string& marker, const std::string& camera,
                      const std::string& other) {
  if (alert.map_loaded) {
    return fmt::format("a map was loaded; {} judged anew",
                       alert.marker ? "marker " + marker + " is" : camera + " is");
  }
  switch (alert.kind) {
    case AlertKind::marker_moved:
      return fmt::format("marker {} hangs where the map says; it is used again", marker);
    case AlertKind::marker_unknown:
      return fmt::format("marker {}, which is not in the map, is not seen any more", marker);
    case AlertKind::image_frozen:
    case AlertKind::image_stale:
      return fmt::format("{} gives new images; it is used again", camera);
    case AlertKind::image_unsearched:
      return fmt::format("{}'s images are searched for markers again", camera);
    case AlertKind::image_dark:
    case AlertKind::image_saturated:
    case AlertKind::image_obscured:
      return fmt::format("{} sees something again; it is used again", camera);
    case AlertKind::extrinsics_off:
      return fmt::format("{} stands where the rig file says; it is used again", camera);
    case AlertKind::cameras_swapped:
      return fmt::format("{} and {} are each in their own place", camera, other);
    case AlertKind::camera_missing:
      return fmt::format("{} delivers frames", camera);
    case AlertKind::stamps_unsynced:
      return fmt::format("{}'s stamps are believed again", camera);
    case AlertKind::stamps_skewed:
      if (alert.camera < 0) return "the cameras expose together";
      return fmt::format("{}'s images are as old as their stamps; it is used again", camera);
    case AlertKind::lens_off:
      return fmt::format("{}'s lens is what the rig file says; it is used again", camera);
    case AlertKind::readout_off:
      return fmt::format("{}'s rows are read as stated; it is used again", camera);
    case AlertKind::corners_noisy:
      return fmt::format("{}'s corners are as certain as usual", camera);
    case AlertKind::map_wrong:
      return "markers hang where the map says";
    case AlertKind::marker_riding:
      return fmt::format("marker {} hangs where the map says; it is used again", marker);
    case AlertKind::settings_changed:
      return fmt::format("{} keeps its settings", camera);
  }
  return "";
}

}  // namespace

std::string_view name_of(AlertKind kind) { return kNames.at(static_cast<std::size_t>(kind)); }

bool same_subject(const Alert& a, const Alert& b) {
  const auto [a_first, a_last] = std::minmax(a.camera, a.other_camera);
  const auto [b_first, b_last] = std::minmax(b.camera, b.other_camera);
  return a.kind == b.kind && a.marker == b.marker && a_first == b_first && a_last == b_last;
}

std::string subject_of(const Alert& alert, const Rig& rig, bool several_families) {
  if (alert.marker) return format_marker_id(*alert.marker, several_families);
  return alert.camera < 0 ? "" : camera_name(rig, alert.camera);
}

std::string log_key(const Alert& alert, const Rig& rig, bool several_families) {
  return fmt::format("{}{} {}", name_of(alert.kind), alert.raised ? "" : " is over",
                     subject_of(alert, rig, several_families));
}

std::string alert_text(const Alert& alert, const Rig& rig, bool several_families) {
  const std::string marker =
      alert.marker ? format_marker_id(*alert.marker, several_families) : std::string("?");
  const auto text = alert.raised ? raised_text : over_text;
  return fmt::format(
      "{}{}: {}", name_of(alert.kind), alert.raised ? "" : " is over",
      text(alert, marker, camera_name(rig, alert.camera), camera_name(rig, alert.other_camera)));
}

}  // namespace waymark
