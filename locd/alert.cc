#include "locd/alert.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

namespace waymark {
namespace {

constexpr std::array<std::string_view, 12> kNames = {
    "MOVED",      "UNKNOWN", "FROZEN",  "DARK",     "SATURATED", "OBSCURED",
    "EXTRINSICS", "SWAP",    "MISSING", "UNSYNCED", "SKEW",      "SETTINGS"};

std::string camera_name(const Rig& rig, int camera) {
  if (camera < 0 || static_cast<std::size_t>(camera) >= rig.cameras.size()) return "the rig";
  return rig.cameras[static_cast<std::size_t>(camera)].name;
}

std::string offset_text(const Alert& alert) {
  const double offset_deg = alert.offset_rad * 180.0 / std::numbers::pi;
  return fmt::format("{:.3f} m and {:.1f} deg", alert.offset_m, offset_deg);
}

}  // namespace

std::string_view name_of(AlertKind kind) { return kNames.at(static_cast<std::size_t>(kind)); }

std::string describe(const Alert& alert, const Rig& rig, bool several_families) {
  const std::string camera = camera_name(rig, alert.camera);
  const std::string marker =
      alert.marker ? format_marker_id(*alert.marker, several_families) : std::string("?");
  const auto line = [&](const std::string& what) {
    return fmt::format("{}{}: {}", name_of(alert.kind), alert.raised ? "" : " is over", what);
  };
  switch (alert.kind) {
    case AlertKind::marker_moved:
      return line(
          fmt::format("marker {} hangs {} from where the map says; it is not used any more; "
                      "put it back, or map anew",
                      marker, offset_text(alert)));
    case AlertKind::marker_unknown:
      return line(fmt::format("marker {} is not in the map; map anew to use it", marker));
    case AlertKind::image_frozen:
      return line(fmt::format("{} repeats one image; it is not used; restart the camera", camera));
    case AlertKind::image_dark:
      return line(
          fmt::format("{} sees nothing but black; is its lens covered, the light off?", camera));
    case AlertKind::image_saturated:
      return line(fmt::format("{} sees nothing but white; lower exposure or gain", camera));
    case AlertKind::image_obscured:
      return line(fmt::format("{} sees nothing but a blur; clean its lens", camera));
    case AlertKind::extrinsics_off:
      return line(fmt::format("{} stands {} from where the rig file says; calibrate the rig",
                              camera, offset_text(alert)));
    case AlertKind::cameras_swapped:
      return line(fmt::format("{} and {} are in each other's place; swap their plugs or serials",
                              camera, camera_name(rig, alert.other_camera)));
    case AlertKind::camera_missing:
      return line(fmt::format("{} delivers no frames; check its cable", camera));
    case AlertKind::stamps_unsynced:
      return line(fmt::format("{}'s stamps can't be believed; arrival times are used", camera));
    case AlertKind::stamps_skewed:
      return line("the cameras do not expose together; check the trigger");
    case AlertKind::settings_changed:
      return line(
          fmt::format("another program changes settings of {}; they are set again, stamps are "
                      "approximate until "
                      "then; end that program (fuser -v /dev/video*)",
                      camera));
  }
  return line("");
}

}  // namespace waymark
