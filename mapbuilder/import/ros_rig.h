#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/camera/kalibr.h"
#include "mapbuilder/import/ros_messages.h"

namespace waymark {

/// What a recording tells of one camera's lens.
struct RecordedLens {
  std::string topic;  ///< of its camera_info, for messages
  RosCameraInfo info;
  bool rectified = false;  ///< its images are, so that the projection matrix is theirs
};

/// The rig of cameras that their drivers' camera_info describes, cam0 first; without transforms,
/// which camera_info does not have. bad_data where one is not calibrated, is binned or cropped, or
/// of a lens that is not read.
[[nodiscard]] Expected<LoadedRig> rig_of_lenses(const std::vector<RecordedLens>& lenses);

/// Whether a topic's images are rectified, by ROS's custom: "/left/image_rect_color".
[[nodiscard]] bool is_rectified_topic(std::string_view image_topic);

/// The topics on which ROS's custom has an image topic's camera_info, the likeliest first.
[[nodiscard]] std::vector<std::string> camera_info_topics(std::string_view image_topic);

}  // namespace waymark
