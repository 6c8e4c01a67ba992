#pragma once

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/base/range.h"
#include "mapbuilder/import/described_capture.h"

namespace waymark {

/// A recording of ROS 2, and what becomes a capture with its images.
struct BagImportOptions {
  std::filesystem::path bag;       ///< rosbag2's folder, or a file of either storage
  std::filesystem::path output;    ///< the capture folder
  CaptureDescription description;  ///< what goes beside
  /// Topics of images, cam0's first; empty: all that there are, by name.
  std::vector<std::string> topics;
  int every = 1;  ///< one of so many images of each topic is taken; the first always

  static constexpr Range kEvery{1, 1'000'000};
};

/// Cameras that one recording may have.
inline constexpr std::size_t kMostBagCameras = 64;

/// Writes a recording's images as a capture folder, each named by its header.stamp: JPEG and PNG as
/// they were recorded, raw images as pgm_of_ros_image makes them. Without a rig file that was
/// named, rig.yaml is made of the cameras' camera_info, if all have one. Which topic became which
/// camera goes to `out`, what is still missing or was left out to `notes`, a line each. The folder
/// appears whole, or not at all, and takes no other's place. Errors: usage for options out of
/// range; those of files_of_recording, open_recorded and GrowingFolder; bad_data for a recording
/// without images, without a topic that was named, with images that change their size or are not
/// read, with stamps that are 0, or that the rig file does not fit.
[[nodiscard]] Status import_bag(const BagImportOptions& options, Progress& progress,
                                std::ostream& out, std::ostream& notes);

}  // namespace waymark
