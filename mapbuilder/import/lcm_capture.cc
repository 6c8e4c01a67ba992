#include "mapbuilder/import/lcm_capture.h"

#include <fmt/ostream.h>

#include <algorithm>

#include "core/base/growing_folder.h"
#include "core/camera/kalibr.h"
#include "core/camera/rig_fingerprint.h"
#include "core/capture/detections_csv_text.h"

namespace waymark {
namespace {

/// What a table asks of a rig: its cameras' names.
Rig named_cameras(std::size_t count) {
  CameraParameters any;
  any.width_px = any.height_px = 1;
  any.fu_px = any.fv_px = 1;
  Rig rig;
  for (std::size_t i = 0; i < count; ++i) {
    rig.cameras.push_back(
        {fmt::format("cam{}", i), CameraModel::create(any).value(), {}, {}, {}, {}, {}, {}});
  }
  return rig;
}

bool every_marker_has_covariances(const LoggedDetections& logged) {
  return std::all_of(logged.images.begin(), logged.images.end(), [](const ImageDetections& image) {
    return std::all_of(image.detections.begin(), image.detections.end(),
                       [](const Detection& d) { return d.covariances.has_value(); });
  });
}

std::string csv_of(const LoggedDetections& logged) {
  const bool with_covariances = every_marker_has_covariances(logged);
  std::string text = detections_csv_columns(with_covariances);
  append_detections_csv_rows(logged.images, named_cameras(logged.cameras), true, with_covariances,
                             text);
  return text;
}

/// The session's name is digits that locd drew; whatever else stands there is left out.
std::string capture_toml(const LoggedDetections& logged) {
  std::string session = logged.session;
  if (session.find_first_not_of("0123456789abcdef") != std::string::npos) session.clear();
  return fmt::format("clock = \"realtime\"\nsession = \"{}\"\nsync_tolerance_us = {}\n", session,
                     logged.sync_tolerance / std::chrono::microseconds(1));
}

Status check_rig(const LcmCaptureOptions& options, const LoggedDetections& logged) {
  const auto& path = options.description.rig;
  if (!path) return {};
  const auto loaded = read_camchain(*path);
  if (!loaded) return tl::make_unexpected(loaded.error());
  return check_rig_of_log(logged, loaded->rig, *path);
}

}  // namespace

Status check_rig_of_log(const LoggedDetections& logged, const Rig& rig,
                        const std::filesystem::path& path) {
  if (rig.cameras.size() != logged.cameras) {
    return fail(ErrorKind::bad_data,
                "{}: {} cameras, but locd's rig had {}; name the file that it had", path.string(),
                rig.cameras.size(), logged.cameras);
  }
  if (logged.rig_fingerprint.empty() || logged.rig_fingerprint == fingerprint(rig)) return {};
  return fail(
      ErrorKind::bad_data,
      "{}: not the rig file that locd had while it logged: its fingerprint is {}, that of the "
      "log {}",
      path.string(), fingerprint(rig), logged.rig_fingerprint);
}

Status import_lcm_log(const LcmCaptureOptions& options, Progress& progress, std::ostream& out,
                      std::ostream& notes) {
  auto folder = GrowingFolder::begin(options.output);
  if (!folder) return tl::make_unexpected(folder.error());
  const auto logged = read_lcm_detections(options.log, options.channel, progress);
  if (!logged) return tl::make_unexpected(logged.error());
  if (auto fits = check_rig(options, *logged); !fits) return fits;
  Status written = describe_capture(options.description, folder->path());
  if (written) written = write_new_file(folder->path() / "detections.csv", csv_of(*logged));
  if (written) written = write_new_file(folder->path() / "capture.toml", capture_toml(*logged));
  if (written) written = folder->finish();
  if (!written) return written;
  std::size_t markers = 0;
  for (const ImageDetections& image : logged->images) markers += image.detections.size();
  fmt::print(out, "{}: {} frame sets of {} cameras, {} markers, from {}; rig {}\n",
             in_one_line(options.output.string()), logged->frame_sets, logged->cameras, markers,
             in_one_line(logged->channel),
             logged->rig_fingerprint.empty() ? "not told" : in_one_line(logged->rig_fingerprint));
  tell_what_is_missing(options.output, notes);
  return {};
}

}  // namespace waymark
