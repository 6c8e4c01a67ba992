#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/error.h"
#include "core/base/input_file.h"

namespace waymark {

/// Bytes that come one after the other: of a file, or unpacked on the way.
class ByteSource {
 public:
  ByteSource() = default;
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;
  virtual ~ByteSource() = default;

  /// Fills the buffer as far as there are bytes; fewer than that: the end. Errors: bad_data, io.
  [[nodiscard]] virtual Expected<std::size_t> read(std::span<std::uint8_t> buffer) = 0;
};

/// A file's bytes through a block of memory, so that small reads cost nothing.
class FileSource : public ByteSource {
 public:
  explicit FileSource(InputFile file) : file_(std::move(file)) {}

  [[nodiscard]] Expected<std::size_t> read(std::span<std::uint8_t> buffer) override;

  /// Bytes that were given so far.
  [[nodiscard]] std::uintmax_t position() const { return position_; }
  /// Of the file when it was opened.
  [[nodiscard]] std::uintmax_t size() const { return file_.size(); }

 private:
  InputFile file_;
  std::vector<std::uint8_t> block_;
  std::size_t begin_ = 0;  ///< of what is not given yet, in the block
  std::uintmax_t position_ = 0;
};

/// The first `size` bytes of another source and no more, so that nothing within them reaches what
/// lies behind.
class PartSource : public ByteSource {
 public:
  PartSource(ByteSource& whole, std::uint64_t size) : whole_(whole), left_(size) {}

  [[nodiscard]] Expected<std::size_t> read(std::span<std::uint8_t> buffer) override;

  [[nodiscard]] std::uint64_t left() const { return left_; }

 private:
  ByteSource& whole_;
  std::uint64_t left_;
};

/// Fills the whole buffer; false where the source ends before that.
[[nodiscard]] Expected<bool> read_whole(ByteSource& source, std::span<std::uint8_t> buffer);

/// Passes over `count` bytes; false where the source ends before that.
[[nodiscard]] Expected<bool> pass_over(ByteSource& source, std::uint64_t count);

}  // namespace waymark
