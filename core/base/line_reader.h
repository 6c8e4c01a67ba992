#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/base/input_file.h"

namespace waymark {

/// A text file line by line, of which no more than a block is held: however large it is, memory is
/// that of the longest line.
class LineReader {
 public:
  /// `name` is the file's in errors. Lines of more than `longest` bytes are refused.
  LineReader(InputFile file, std::string name, std::size_t longest);

  /// The next line without its end, valid until the next call; nullopt behind the last. Errors:
  /// those of InputFile::read; bad_data for a line that is too long.
  [[nodiscard]] Expected<std::optional<std::string_view>> next();

  /// Of the line that next gave last; from 1 on.
  [[nodiscard]] std::size_t number() const { return number_; }

 private:
  [[nodiscard]] Status refill();

  InputFile file_;
  std::string name_;
  std::size_t longest_;
  std::string buffer_;
  std::size_t begin_ = 0;  ///< of what is not given yet, in the buffer
  bool at_end_ = false;    ///< of the file
  std::size_t number_ = 0;
};

}  // namespace waymark
