#pragma once

#include <filesystem>

#include "core/base/error.h"
#include "core/capture/capture_folder.h"

namespace waymark {

/// Opens a capture in whichever layout it has: Waymark's capture folder or the paper's. Errors:
/// those of open_capture_folder and open_paper_layout; no_input for a path that is neither.
[[nodiscard]] Expected<CaptureFolder> open_capture(const std::filesystem::path& path,
                                                   RigFile rig_file = RigFile::required);

}  // namespace waymark
