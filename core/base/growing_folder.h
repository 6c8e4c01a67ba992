#pragma once

#include <filesystem>
#include <string_view>

#include "core/base/error.h"

namespace waymark {

/// A folder in the making: it grows beside its final place and moves there when it is whole, so
/// that nobody reads half of it and one that is there already is never touched.
class GrowingFolder {
 public:
  /// cant_create when `final_path` exists and is not an empty folder, or its parent can't be
  /// written.
  [[nodiscard]] static Expected<GrowingFolder> begin(const std::filesystem::path& final_path);

  GrowingFolder(GrowingFolder&& other) noexcept;
  GrowingFolder(const GrowingFolder&) = delete;
  GrowingFolder& operator=(const GrowingFolder&) = delete;
  GrowingFolder& operator=(GrowingFolder&&) = delete;
  /// Removes what was written unless finish() moved it to its place.
  ~GrowingFolder();

  /// Where its files are written now.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Moves it to its place, once the disk has it all.
  [[nodiscard]] Status finish();

 private:
  GrowingFolder(std::filesystem::path final_path, std::filesystem::path path)
      : final_path_(std::move(final_path)), path_(std::move(path)) {}

  std::filesystem::path final_path_;
  std::filesystem::path path_;  ///< empty once finished or moved from
};

/// Creates a folder; cant_create or permission with the reason.
[[nodiscard]] Status create_folder(const std::filesystem::path& path);

/// Writes a file of a folder in the making: not waiting for the disk, as write_file_atomically
/// does. cant_create and permission when something has the name, io when it can't be written.
[[nodiscard]] Status write_new_file(const std::filesystem::path& path, std::string_view content);

}  // namespace waymark
