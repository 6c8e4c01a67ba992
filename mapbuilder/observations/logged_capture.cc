#include "mapbuilder/observations/logged_capture.h"

#include "core/camera/kalibr.h"
#include "core/capture/foreign_csv.h"
#include "mapbuilder/import/lcm_capture.h"

namespace waymark {
namespace {

/// Leaves out what the catalog does not know, and tells how much that was.
void keep_known(DetectedCapture& capture, DetectionReport& report) {
  std::size_t unknown = 0;
  CornerOrders orders;
  for (ImageDetections& image : capture.images) {
    std::erase_if(image.detections, [&](const Detection& detection) {
      if (capture.catalog.size_m(detection.marker)) return !orders.add(detection.corners);
      ++unknown;
      if (!capture.catalog.ignores(detection.marker)) ++capture.unlisted[detection.marker];
      return true;
    });
    report.detections += image.detections.size();
  }
  if (unknown > 0) {
    report.warnings.push_back(
        fmt::format("{}: {} detections left out, markers.toml ignores or lacks their ids",
                    capture.name, unknown));
  }
  if (orders.misordered() > 0) {
    report.warnings.push_back(
        fmt::format("{}: {} detections left out, their corners do not run clockwise from top-left",
                    capture.name, orders.misordered()));
  }
}

}  // namespace

Expected<DetectedCapture> take_logged_capture(const LoggedCapture& logged, Progress& progress,
                                              DetectionReport& report) {
  auto loaded = read_camchain(logged.rig_yaml);
  if (!loaded) return tl::make_unexpected(loaded.error());
  report.warnings = std::move(loaded->notes);
  auto catalog = read_marker_catalog(logged.markers_toml);
  if (!catalog) return tl::make_unexpected(catalog.error());
  auto read = read_lcm_detections(logged.log, {}, progress);
  if (!read) return tl::make_unexpected(read.error());
  if (auto fits = check_rig_of_log(*read, loaded->rig, logged.rig_yaml); !fits) {
    return tl::make_unexpected(fits.error());
  }
  DetectedCapture capture;
  capture.name = logged.log.string();
  capture.rig = std::move(loaded->rig);
  capture.catalog = std::move(*catalog);
  capture.images = std::move(read->images);
  capture.sync_tolerance = read->sync_tolerance;
  report.images = capture.images.size();
  keep_known(capture, report);
  fit_sync_tolerance(capture, report);
  return capture;
}

}  // namespace waymark
