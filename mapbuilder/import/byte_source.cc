#include "mapbuilder/import/byte_source.h"

#include <algorithm>
#include <array>

namespace waymark {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 16;

}  // namespace

Expected<std::size_t> FileSource::read(std::span<std::uint8_t> buffer) {
  std::size_t filled = 0;
  while (filled < buffer.size()) {
    if (begin_ == block_.size()) {
      block_.resize(kBlock);
      begin_ = 0;
      // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes of a file
      const auto got = file_.read({reinterpret_cast<char*>(block_.data()), block_.size()});
      if (!got) return tl::make_unexpected(got.error());
      block_.resize(*got);
      if (*got == 0) break;
    }
    const std::size_t count = std::min(buffer.size() - filled, block_.size() - begin_);
    std::copy_n(block_.begin() + static_cast<std::ptrdiff_t>(begin_), count,
                buffer.begin() + static_cast<std::ptrdiff_t>(filled));
    begin_ += count;
    filled += count;
  }
  position_ += filled;
  return filled;
}

Expected<std::size_t> PartSource::read(std::span<std::uint8_t> buffer) {
  const auto got = whole_.read(buffer.first(std::min<std::uint64_t>(buffer.size(), left_)));
  if (got) left_ -= *got;
  return got;
}

Expected<bool> read_whole(ByteSource& source, std::span<std::uint8_t> buffer) {
  const auto got = source.read(buffer);
  if (!got) return tl::make_unexpected(got.error());
  return *got == buffer.size();
}

Expected<bool> pass_over(ByteSource& source, std::uint64_t count) {
  std::array<std::uint8_t, kBlock> passed;
  while (count > 0) {
    const auto part = std::span(passed).first(std::min<std::uint64_t>(count, passed.size()));
    const auto whole = read_whole(source, part);
    if (!whole || !*whole) return whole;
    count -= part.size();
  }
  return true;
}

}  // namespace waymark
