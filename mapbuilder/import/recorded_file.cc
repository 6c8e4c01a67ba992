#include "mapbuilder/import/recorded_file.h"

#include <array>
#include <limits>

#include "core/base/input_file.h"
#include "mapbuilder/import/lcm_log.h"

namespace waymark {

Expected<RecordedFile> kind_of_file(const std::filesystem::path& path) {
  auto file = InputFile::open(path, std::numeric_limits<std::uintmax_t>::max());
  if (!file) return tl::make_unexpected(file.error());
  std::array<char, 16> front{};
  const auto got = file->read(front);
  if (!got) return tl::make_unexpected(got.error());
  const std::string_view bytes(front.data(), *got);
  if (LcmLog::looks_like(bytes)) return RecordedFile::lcm_log;
  if (bytes.starts_with("\x89MCAP")) return RecordedFile::mcap;
  if (bytes.starts_with("SQLite format 3")) return RecordedFile::sqlite;
  if (bytes.starts_with("#ROSBAG V")) return RecordedFile::ros1_bag;
  if (bytes.starts_with("\x28\xB5\x2F\xFD")) return RecordedFile::zstd;
  return RecordedFile::other;
}

}  // namespace waymark
