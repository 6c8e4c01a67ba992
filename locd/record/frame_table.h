#pragma once

#include <cstdint>
#include <functional>
#include <string_view>

#include "core/base/descriptor.h"
#include "core/base/error.h"
#include "core/geometry/stamp.h"
#include "locd/record/own_folder.h"

namespace waymark {

/// frames.csv of a recording, a row per image: camera,t_ns,exposure_ns,sequence,stamp_quality.
/// Whenever the process dies, there are whole rows in it.
class FrameTable {
 public:
  /// Creates it, or goes on with the one there; a row that a power cut left in part is taken off.
  /// Errors: cant_create (something else than a file of locd's is there), permission, io.
  [[nodiscard]] static Expected<FrameTable> open(const OwnFolder& recording);

  /// Appends whole rows, each with its line end: all, or none with io.
  [[nodiscard]] Status append(std::string_view rows);

  /// Rewrites it with the rows of images that are `kept`, atomically. Errors: those of open and of
  /// write_file_atomically; then it is as it was.
  using Kept = std::function<bool(std::string_view camera, Stamp stamp)>;
  [[nodiscard]] Status forget_all_but(const Kept& kept);

  /// Brings it to the disk; false, with errno, when that fails.
  [[nodiscard]] bool sync();

  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  [[nodiscard]] std::uint64_t rows() const { return rows_; }

 private:
  explicit FrameTable(OwnFolder recording);
  [[nodiscard]] Status open_file();
  [[nodiscard]] Status take_stock();

  OwnFolder recording_;
  std::filesystem::path path_;
  Descriptor file_;
  std::uint64_t bytes_ = 0;
  std::uint64_t rows_ = 0;
};

}  // namespace waymark
