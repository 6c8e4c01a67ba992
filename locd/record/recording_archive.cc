#include "locd/record/recording_archive.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <ctime>
#include <string>
#include <utility>

#include "core/base/atomic_file.h"
#include "core/base/folder_walk.h"
#include "core/base/system_call.h"
#include "core/base/text_field.h"

namespace waymark {

namespace fs = std::filesystem;

bool recorded_by_locd(const fs::path& capture) {
  constexpr std::size_t kMaxBytes = 1 << 16;
  const auto facts = read_file(capture / "capture.toml", kMaxBytes);
  return facts && ("\n" + *facts).find(std::string("\n") + kRecordedByLocd) != std::string::npos;
}

Expected<fs::path> new_recording_folder(const fs::path& archive) {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  std::array<char, 32> name{};
  const std::size_t length = std::strftime(name.data(), name.size(), "%Y%m%dT%H%M%SZ", &utc);
  const std::string date(name.data(), length);
  std::error_code failed;
  fs::create_directories(archive, failed);
  fs::path folder = archive / date;
  for (int i = 2; !failed && !fs::create_directory(folder, failed) && !failed; ++i) {
    folder = archive / fmt::format("{}-{}", date, i);
  }
  if (!failed) return folder;
  errno = failed.value();
  return fail(creation_error(), "{}: can't create: {}", folder.string(), system_reason());
}

RecordingArchive::RecordingArchive(const fs::path& folder, const fs::path& own) {
  walk_folder<fs::directory_iterator>(folder, [&](const fs::directory_entry& entry) {
    std::error_code unknown;
    const bool is_own = fs::equivalent(entry.path(), own, unknown);
    if (unknown || is_own || entry.is_symlink(unknown) || !recorded_by_locd(entry.path())) return;
    recordings_.push_back(weigh(entry.path()));
    bytes_ += recordings_.back().bytes;
  });
  std::sort(recordings_.begin(), recordings_.end(),
            [](const auto& a, const auto& b) { return a.newest < b.newest; });
}

RecordingArchive::Recording RecordingArchive::weigh(const fs::path& path) {
  Recording recording{path, 0, Stamp{0}};
  walk_folder<fs::recursive_directory_iterator>(path, [&](const fs::directory_entry& file) {
    std::error_code gone;
    if (!file.is_regular_file(gone)) return;
    const auto bytes = file.file_size(gone);
    if (!gone) recording.bytes += bytes;
    const auto t_ns = parse_whole<std::int64_t>(file.path().stem().string());
    if (t_ns) recording.newest = std::max(recording.newest, Stamp(*t_ns));
  });
  return recording;
}

void RecordingArchive::delete_oldest() {
  std::error_code ignored;  // what stays is found again by the next recording
  fs::remove_all(recordings_.front().path, ignored);
  bytes_ -= recordings_.front().bytes;
  recordings_.pop_front();
}

}  // namespace waymark
