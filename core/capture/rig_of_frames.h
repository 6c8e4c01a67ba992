#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/camera/rig.h"
#include "core/marker/marker_catalog.h"

namespace waymark {

/// Where a capture's frames are.
struct FramePlaces {
  /// Holds the folders camK, or the images of a single camera; need not be there.
  std::filesystem::path images;
  std::optional<std::filesystem::path> detections_csv;
  bool monotonic = false;  ///< as for doubt_of_stamps
};

/// The rig of a capture without a rig file: cameras by their folders, or by the names in
/// detections.csv; their sizes by the first image of each that can be read. Without images the
/// least common sensor size that holds all cameras' corners is taken, and said in `notes`.
/// All else is a guess to start from: a straight lens of 53° across, axis in the middle, no
/// transforms, sigma_source hand. Errors: no_input (neither images nor detections); bad_data (gaps
/// in the cameras' numbers, no image of a camera that can be read, errors of the CSV); permission
/// and io.
[[nodiscard]] Expected<Rig> rig_of_frames(const FramePlaces& places, const MarkerCatalog& catalog,
                                          std::vector<std::string>& notes);

}  // namespace waymark
