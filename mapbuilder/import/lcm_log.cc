#include "mapbuilder/import/lcm_log.h"

#include <array>

#include "mapbuilder/import/byte_cursor.h"

namespace waymark {
namespace {

constexpr std::uint32_t kSync = 0xEDA1DA01;
constexpr std::string_view kSyncBytes = "\xED\xA1\xDA\x01";

/// What stands before an event's channel and message; all numbers the highest byte first.
struct EventHead {
  static constexpr std::size_t kBytes = 28;

  explicit EventHead(std::span<const std::uint8_t, kBytes> bytes) {
    ByteCursor cursor(bytes, std::endian::big);
    sync = cursor.number<std::uint32_t>();
    (void)cursor.number<std::int64_t>();  // the event's number
    timestamp_us = cursor.number<std::int64_t>();
    channel_size = cursor.number<std::uint32_t>();
    data_size = cursor.number<std::uint32_t>();
  }

  std::uint32_t sync;
  std::int64_t timestamp_us;
  std::uint32_t channel_size;
  std::uint32_t data_size;
};

}  // namespace

bool LcmLog::looks_like(std::string_view first_bytes) {
  return first_bytes.starts_with(kSyncBytes);
}

Expected<LcmLog> LcmLog::open(const std::filesystem::path& path) {
  auto file = InputFile::open(path, kLargestLog);
  if (!file) return tl::make_unexpected(file.error());
  return LcmLog(path.string(), std::make_unique<FileSource>(std::move(*file)));
}

Expected<std::optional<LcmEvent>> LcmLog::next() {
  const std::uintmax_t at = source_->position();
  std::array<std::uint8_t, EventHead::kBytes> bytes{};
  const auto got = source_->read(bytes);
  if (!got) return tl::make_unexpected(got.error());
  if (*got == 0) return std::nullopt;
  if (*got < bytes.size()) return cut_off(at);
  const EventHead head(bytes);
  if (head.sync != kSync) return damaged(at, "no event begins there");
  if (head.channel_size == 0 || head.channel_size > kLongestChannel) {
    return damaged(at, fmt::format("a channel's name of {} bytes", head.channel_size));
  }
  const std::uintmax_t end = source_->position() + head.channel_size + head.data_size;
  if (end > source_->size()) return cut_off(at);
  LcmEvent event;
  event.timestamp_us = head.timestamp_us;
  event.size = head.data_size;
  const bool held = head.data_size <= kLargestMessage;
  data_.resize(head.channel_size + (held ? head.data_size : 0));
  auto whole = read_whole(*source_, data_);
  if (whole && *whole && !held) whole = pass_over(*source_, head.data_size);
  if (!whole) return tl::make_unexpected(whole.error());
  if (!*whole) return cut_off(at);
  event.channel.assign(data_.begin(), data_.begin() + head.channel_size);
  event.data = std::span<const std::uint8_t>(data_).subspan(head.channel_size);
  return event;
}

tl::unexpected<Error> LcmLog::damaged(std::uintmax_t at, std::string_view why) const {
  return fail(ErrorKind::bad_data,
              "{}: damaged LCM log: at byte {} {}; head -c {} gives what is whole", name_, at, why,
              at);
}

tl::unexpected<Error> LcmLog::cut_off(std::uintmax_t at) const {
  return fail(
      ErrorKind::bad_data,
      "{}: truncated LCM log: its last event, at byte {}, is cut off; head -c {} gives what is "
      "whole",
      name_, at, at);
}

}  // namespace waymark
