#pragma once

#include <filesystem>

#include "core/base/error.h"
#include "core/capture/capture_folder.h"

namespace waymark {

/// Whether a folder looks like one of the paper's data sets: sfm.toml, and no markers.toml.
[[nodiscard]] bool is_paper_layout(const std::filesystem::path& path);

/// Opens a data set of the paper as a capture:
///   images/      all images of one camera; several cameras: images/cam0, images/cam1…
///   sfm.toml     [marker] type = "aruco" | "apriltag", family = "4x4_1000" (or Waymark's names),
///                board_size = [[0.3, 0.25], [["default"], ["100-199", 205]]] (m), or one number
///   rig.yaml     or else calib.json (one camera; without a stated size, the first image's counts)
/// detections.csv and survey.toml are found as in a capture folder. Errors: no_input (no images;
/// neither rig.yaml nor calib.json where one is required), bad_data (what can't be understood),
/// permission, io.
[[nodiscard]] Expected<CaptureFolder> open_paper_layout(const std::filesystem::path& path,
                                                        RigFile rig_file = RigFile::required);

}  // namespace waymark
