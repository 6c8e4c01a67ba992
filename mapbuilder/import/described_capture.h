#pragma once

#include <filesystem>
#include <optional>
#include <ostream>
#include <string_view>

#include "core/base/error.h"

namespace waymark {

/// What stands beside images and detections in a capture folder, where the user has it.
struct CaptureDescription {
  std::optional<std::filesystem::path> rig;      ///< becomes rig.yaml
  std::optional<std::filesystem::path> markers;  ///< becomes markers.toml
};

/// Copies the files that were named into `folder`. Errors: those of read_camchain,
/// read_marker_catalog and write_new_file, before anything is written.
[[nodiscard]] Status describe_capture(const CaptureDescription& description,
                                      const std::filesystem::path& folder);

/// Says on `notes`, a line each, what a finished capture still lacks to be built.
void tell_what_is_missing(const std::filesystem::path& capture, std::ostream& notes);

}  // namespace waymark
