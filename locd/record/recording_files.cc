#include "locd/record/recording_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "core/base/text_field.h"

namespace waymark {
namespace {

constexpr std::string_view kPgm = ".pgm";
constexpr std::string_view kJpeg = ".jpg";
constexpr std::string_view kPart = ".part";

bool is_unfinished_text(std::string_view name, std::string_view text) {
  // As write_file_atomically names it.
  return name.size() > text.size() + 2 && name[0] == '.' && name.substr(1).starts_with(text) &&
         name[text.size() + 1] == '.';
}

}  // namespace

std::string image_name(Stamp stamp, std::string_view codec) {
  return fmt::format("{}{}", stamp.count(), codec == "jpeg" ? kJpeg : kPgm);
}

std::optional<Stamp> stamp_of_image(std::string_view name) {
  static_assert(kPgm.size() == kJpeg.size());
  if (!name.ends_with(kPgm) && !name.ends_with(kJpeg)) return std::nullopt;
  const auto t_ns = parse_whole<std::int64_t>(name.substr(0, name.size() - kPgm.size()));
  return t_ns && *t_ns >= 0 ? std::optional(Stamp(*t_ns)) : std::nullopt;
}

std::string unfinished_name(std::string_view image) { return fmt::format(".{}{}", image, kPart); }

bool is_unfinished(std::string_view name) {
  if (name.starts_with('.') && name.ends_with(kPart)) {
    return stamp_of_image(name.substr(1, name.size() - 1 - kPart.size())).has_value();
  }
  return std::any_of(kRecordingTexts.begin(), kRecordingTexts.end(),
                     [&](std::string_view text) { return is_unfinished_text(name, text); });
}

bool is_camera_folder(std::string_view name) {
  constexpr std::string_view kCamera = "cam";
  return name.starts_with(kCamera) && parse_whole<unsigned>(name.substr(kCamera.size()));
}

}  // namespace waymark
