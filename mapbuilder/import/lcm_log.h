#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "mapbuilder/import/byte_source.h"

namespace waymark {

/// One message as lcm-logger wrote it.
struct LcmEvent {
  std::string channel;
  std::int64_t timestamp_us = 0;  ///< when it was received, since the epoch
  std::uint32_t size = 0;         ///< of the message, bytes
  /// The message; empty where it is larger than LcmLog::kLargestMessage. Valid until the next call.
  std::span<const std::uint8_t> data;
};

/// A log of lcm-logger, event by event. An own reader, for LCM's allocates what the file states: of
/// an event this one holds its channel and kLargestMessage at most.
class LcmLog {
 public:
  static constexpr std::uint32_t kLargestMessage = std::uint32_t{1} << 20;
  static constexpr std::uint32_t kLongestChannel = 63;  ///< as LCM's own
  static constexpr std::uintmax_t kLargestLog = std::uintmax_t{1} << 40;

  /// Whether a file's first bytes are those of such a log.
  [[nodiscard]] static bool looks_like(std::string_view first_bytes);

  /// Errors: those of InputFile::open.
  [[nodiscard]] static Expected<LcmLog> open(const std::filesystem::path& path);

  /// The next event; nullopt at the end. bad_data where the log is damaged, or its last event cut
  /// off; the line says how much of it is whole.
  [[nodiscard]] Expected<std::optional<LcmEvent>> next();

  /// Bytes read so far, and of the file.
  [[nodiscard]] std::uintmax_t position() const { return source_->position(); }
  [[nodiscard]] std::uintmax_t size() const { return source_->size(); }

 private:
  LcmLog(std::string name, std::unique_ptr<FileSource> source)
      : name_(std::move(name)), source_(std::move(source)) {}

  [[nodiscard]] tl::unexpected<Error> damaged(std::uintmax_t at, std::string_view why) const;
  [[nodiscard]] tl::unexpected<Error> cut_off(std::uintmax_t at) const;

  std::string name_;
  std::unique_ptr<FileSource> source_;
  std::vector<std::uint8_t> data_;
};

}  // namespace waymark
