#include "core/capture/detections_csv_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iterator>

#include "core/base/check.h"
#include "core/capture/detections_csv_columns.h"

namespace waymark {
namespace {

bool every_detection_has_covariances(const std::vector<ImageDetections>& images) {
  bool any = false;
  for (const ImageDetections& image : images) {
    for (const Detection& detection : image.detections) {
      if (!detection.covariances) return false;
      any = true;
    }
  }
  return any;
}

}  // namespace

std::string format_detections_csv(const std::vector<ImageDetections>& images, const Rig& rig,
                                  const MarkerCatalog& catalog, const std::string& detector,
                                  const std::vector<EdgeMove>& moves) {
  const bool with_covariances = every_detection_has_covariances(images);
  std::string text = detections_csv_head(catalog, detector, with_covariances, rig, moves);
  append_detections_csv_rows(images, rig, catalog.several_families(), with_covariances, text);
  return text;
}

std::string detections_csv_head(const MarkerCatalog& catalog, const std::string& detector,
                                bool with_covariances, const Rig& rig,
                                const std::vector<EdgeMove>& moves) {
  std::string text =
      fmt::format("{}{}{}{}\n", kOwnLinePrefix, detector, kFingerprintKey, catalog.fingerprint());
  for (std::size_t c = 0; c < moves.size(); ++c) {
    text += edge_line(rig.cameras.at(c).name, moves[c]) + '\n';
  }
  return text + detections_csv_columns(with_covariances);
}

std::string detections_csv_columns(bool with_covariances) {
  std::string text =
      fmt::format("t_ns,camera,marker_id,{},hamming", fmt::join(kCornerColumns, ","));
  if (with_covariances) text += fmt::format(",{}", fmt::join(kCovarianceColumns, ","));
  return text + '\n';
}

void append_detections_csv_rows(const std::vector<ImageDetections>& images, const Rig& rig,
                                bool with_families, bool with_covariances, std::string& text) {
  auto out = std::back_inserter(text);
  const std::size_t fields_per_detection =
      kCornerColumns.size() + 1 + (with_covariances ? kCovarianceColumns.size() : 0);
  for (const ImageDetections& image : images) {
    const std::string image_fields = fmt::format(
        "{},{},", image.stamp.count(), rig.cameras.at(static_cast<std::size_t>(image.camera)).name);
    if (image.detections.empty()) {
      text += image_fields + std::string(fields_per_detection, ',') + '\n';
    }
    for (const Detection& detection : image.detections) {
      text += image_fields + format_marker_id(detection.marker, with_families);
      for (const auto& corner : detection.corners) {
        fmt::format_to(out, ",{:.4f},{:.4f}", corner.x(), corner.y());
      }
      fmt::format_to(out, ",{}", detection.hamming);
      if (with_covariances) {
        WAYMARK_CHECK(detection.covariances.has_value());
        for (const Eigen::Matrix2d& s : *detection.covariances) {
          fmt::format_to(out, ",{:.9g},{:.9g},{:.9g}", s(0, 0), s(0, 1), s(1, 1));
        }
      }
      text += '\n';
    }
  }
}

}  // namespace waymark
