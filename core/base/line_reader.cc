#include "core/base/line_reader.h"

namespace waymark {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 18;

}  // namespace

LineReader::LineReader(InputFile file, std::string name, std::size_t longest)
    : file_(std::move(file)), name_(std::move(name)), longest_(longest) {}

Status LineReader::refill() {
  buffer_.erase(0, begin_);
  begin_ = 0;
  const std::size_t kept = buffer_.size();
  buffer_.resize(kept + kBlock);
  const auto got = file_.read({buffer_.data() + kept, kBlock});
  if (!got) return tl::make_unexpected(got.error());
  buffer_.resize(kept + *got);
  at_end_ = *got < kBlock;
  return {};
}

Expected<std::optional<std::string_view>> LineReader::next() {
  std::size_t searched = begin_;
  for (;;) {
    const std::size_t end = buffer_.find('\n', searched);
    const bool whole = end != std::string::npos;
    const std::size_t length = (whole ? end : buffer_.size()) - begin_;
    if (length > longest_) {
      return fail(ErrorKind::bad_data, "{}: line {} has more than {} bytes; this is no such file",
                  name_, number_ + 1, longest_);
    }
    if (whole || (at_end_ && length > 0)) {
      const std::string_view line(buffer_.data() + begin_, length);
      begin_ += length + (whole ? 1 : 0);
      ++number_;
      return line;
    }
    if (at_end_) return std::nullopt;
    searched = length;  // where the rest begins once it has moved to the front
    if (auto more = refill(); !more) return tl::make_unexpected(more.error());
  }
}

}  // namespace waymark
