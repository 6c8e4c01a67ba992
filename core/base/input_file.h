#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "core/base/descriptor.h"
#include "core/base/error.h"

namespace waymark {

/// A regular file that is read from its beginning, block by block.
class InputFile {
 public:
  /// Errors: no_input (absent, a folder, a pipe), permission, bad_data: larger than `max_bytes`, or
  /// sparse, with more than 1 MiB of holes: a few bytes on the disk that read as gigabytes of
  /// zeros.
  [[nodiscard]] static Expected<InputFile> open(const std::filesystem::path& path,
                                                std::uintmax_t max_bytes);

  /// When it was opened.
  [[nodiscard]] std::uintmax_t size() const { return size_; }

  /// Fills the buffer as far as the file reaches; fewer bytes than that: its end. io when it can't
  /// be read, bad_data when it has grown beyond `max_bytes` since.
  [[nodiscard]] Expected<std::size_t> read(std::span<char> buffer);

 private:
  InputFile(std::filesystem::path path, Descriptor file, std::uintmax_t size,
            std::uintmax_t max_bytes)
      : path_(std::move(path)), file_(std::move(file)), size_(size), max_bytes_(max_bytes) {}

  std::filesystem::path path_;
  Descriptor file_;
  std::uintmax_t size_;
  std::uintmax_t max_bytes_;
  std::uintmax_t taken_ = 0;
};

}  // namespace waymark
