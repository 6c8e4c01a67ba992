#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/camera/rig.h"
#include "core/capture/detection.h"
#include "core/capture/frame_set.h"
#include "core/capture/image_list.h"
#include "core/marker/marker_catalog.h"

namespace waymark {

/// Whether a capture must say what its cameras are.
enum class RigFile {
  required,
  optional,  ///< without one, the rig is that of its frames (rig_of_frames.h), numbers guessed
};

/// A capture folder (FORMATS): what is there, checked, without any image decoded yet.
struct CaptureFolder {
  std::filesystem::path path;
  Rig rig;
  MarkerCatalog catalog;
  std::vector<ImageFile> images;  ///< by rising (stamp, camera)
  std::optional<std::filesystem::path> detections_csv;
  std::optional<std::filesystem::path> survey_toml;
  Stamp sync_tolerance = kDefaultSyncTolerance;
  bool monotonic = false;  ///< stamps count from the recorder's last start, not from the epoch
  std::string session;     ///< from capture.toml, may be empty
  bool stamps_from_names = true;   ///< false: names are no stamps; sorted, 1 s apart (mono only)
  std::vector<std::string> notes;  ///< what the user should know, one line each
};

/// Opens a capture folder in Waymark's layout. Other files are passed over, hidden ones silently.
/// capture.toml, every key optional: clock = "realtime" | "monotonic", session = "…",
/// sync_tolerance_us = 0…1000000 (default 5000), codec = "…", software = "…",
/// date_known = true | false; no other.
/// Errors: no_input (no such folder; no markers.toml; no rig.yaml where it is required; neither
/// images nor detections.csv), bad_data (a camK folder without an entry in rig.yaml, or the
/// reverse; a name that is no stamp in a capture with several cameras or with other stamps; two
/// images of one camera with one stamp; unreadable rig, catalog or capture.toml), permission, io.
[[nodiscard]] Expected<CaptureFolder> open_capture_folder(const std::filesystem::path& path,
                                                          RigFile rig_file = RigFile::required);

}  // namespace waymark
