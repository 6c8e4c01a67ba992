#include "mapbuilder/import/ros_rig.h"

#include <yaml-cpp/yaml.h>

#include "core/camera/foreign_calibration.h"

namespace waymark {
namespace {

/// "/left/image_raw/compressed" without the transport behind it.
std::string_view raw_topic(std::string_view topic) {
  constexpr std::string_view kTransport = "/compressed";
  if (topic.ends_with(kTransport)) topic.remove_suffix(kTransport.size());
  return topic;
}

/// As ROS writes it into a file, of the images that were recorded.
YAML::Node as_file(const RecordedLens& lens, const std::string& camera) {
  const auto& p = lens.info.projection_matrix;
  const std::vector<double> projection{p[0], p[1], p[2], p[4], p[5], p[6], p[8], p[9], p[10]};
  const auto& k = lens.info.camera_matrix;
  YAML::Node file;
  file["camera_name"] = camera;
  file["image_width"] = lens.info.width_px;
  file["image_height"] = lens.info.height_px;
  file["camera_matrix"]["data"] =
      lens.rectified ? projection : std::vector<double>(k.begin(), k.end());
  file["distortion_model"] = lens.rectified ? "plumb_bob" : lens.info.distortion_model;
  file["distortion_coefficients"]["data"] =
      lens.rectified ? std::vector<double>(4) : lens.info.distortion;
  return file;
}

Status check(const RecordedLens& lens) {
  if (lens.info.camera_matrix[0] == 0) {
    return fail(ErrorKind::bad_data, "{}: not calibrated: its matrix is 0", lens.topic);
  }
  if (lens.info.binned) {
    return fail(ErrorKind::bad_data,
                "{}: binned or cropped, so that its numbers are not the images'", lens.topic);
  }
  return {};
}

}  // namespace

Expected<LoadedRig> rig_of_lenses(const std::vector<RecordedLens>& lenses) {
  YAML::Node chain;
  for (std::size_t i = 0; i < lenses.size(); ++i) {
    const std::string camera = fmt::format("cam{}", i);
    if (auto fine = check(lenses[i]); !fine) return tl::make_unexpected(fine.error());
    const auto meant = camchain_of_foreign(as_file(lenses[i], camera), lenses[i].topic);
    if (!meant) return tl::make_unexpected(meant.error());
    if (!*meant) return fail(ErrorKind::bad_data, "{}: no calibration", lenses[i].topic);
    chain[camera] = (**meant)["cam0"];
  }
  return parse_camchain(YAML::Dump(chain), "camera_info");
}

bool is_rectified_topic(std::string_view image_topic) {
  const std::string_view raw = raw_topic(image_topic);
  return raw.substr(raw.rfind('/') + 1).starts_with("image_rect");
}

std::vector<std::string> camera_info_topics(std::string_view image_topic) {
  const std::string_view raw = raw_topic(image_topic);
  const std::string_view above = raw.substr(0, raw.rfind('/') + 1);
  return {std::string(above) + "camera_info", std::string(raw) + "/camera_info"};
}

}  // namespace waymark
