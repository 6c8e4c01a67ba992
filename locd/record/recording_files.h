#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "core/geometry/stamp.h"

namespace waymark {

/// What locd names the files of a recording. Only what bears such a name is ever deleted.
inline constexpr const char* kCaptureToml = "capture.toml";
inline constexpr const char* kFrameTable = "frames.csv";
inline constexpr const char* kMarkTable = "marks.csv";
/// Of every recording, beside its camera folders; capture.toml by which it is known goes last.
inline constexpr std::array<const char*, 5> kRecordingTexts = {kFrameTable, kMarkTable, "rig.yaml",
                                                               "markers.toml", kCaptureToml};

/// "1800000000000000000.pgm"
[[nodiscard]] std::string image_name(Stamp stamp, std::string_view codec);
/// The stamp of an image, whatever codec it was recorded in; nullopt: no image of locd's.
[[nodiscard]] std::optional<Stamp> stamp_of_image(std::string_view name);

/// How an image is named while it is written.
[[nodiscard]] std::string unfinished_name(std::string_view image);
/// Whether a killed process left it half-written: an image, or one of the texts.
[[nodiscard]] bool is_unfinished(std::string_view name);

/// "cam0", "cam1"…
[[nodiscard]] bool is_camera_folder(std::string_view name);

}  // namespace waymark
