#pragma once

#include <filesystem>
#include <string_view>

namespace waymark {

/// The name of an image format that is known but not read ("BMP", "TIFF", "WebP", …) to which a
/// file belongs by its name's ending; empty for every other file.
[[nodiscard]] std::string_view foreign_format_of_name(const std::filesystem::path& path);

/// The same by what the file holds.
[[nodiscard]] std::string_view foreign_format_of_content(std::string_view bytes);

}  // namespace waymark
