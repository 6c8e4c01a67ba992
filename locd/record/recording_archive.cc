#include "locd/record/recording_archive.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <ctime>
#include <utility>

#include "core/base/system_call.h"
#include "locd/frames/realtime.h"

namespace waymark {

namespace fs = std::filesystem;

Expected<fs::path> new_recording_folder(const fs::path& archive, const std::string& name) {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  std::array<char, 32> text{};
  const std::size_t length = std::strftime(text.data(), text.size(), "%Y%m%dT%H%M%SZ", &utc);
  std::string stem(text.data(), length);
  if (!name.empty()) stem += "-" + name;
  std::error_code failed;
  fs::create_directories(archive, failed);
  fs::path folder = archive / stem;
  for (int i = 2; !failed && !fs::create_directory(folder, failed) && !failed; ++i) {
    folder = archive / fmt::format("{}-{}", stem, i);
  }
  if (!failed) return folder;
  errno = failed.value();
  return fail(creation_error(), "{}: can't create: {}", folder.string(), system_reason());
}

Expected<std::optional<std::string>> check_archive(const fs::path& archive) {
  std::error_code why;
  fs::path place = fs::absolute(archive, why).lexically_normal();
  // Up to what is there.
  while (fs::symlink_status(place, why).type() == fs::file_type::not_found &&
         place.has_relative_path()) {
    place = place.parent_path();
  }
  if (!fs::is_directory(place, why)) {
    return fail(ErrorKind::config, "[record] dir {}: {} is no folder{}", archive.string(),
                place.string(), why ? ": " + why.message() : "");
  }
  if (::faccessat(AT_FDCWD, place.c_str(), W_OK | X_OK, AT_EACCESS) == 0) return std::nullopt;
  return fmt::format("{}: recordings go there, and this user may not write there", place.string());
}

namespace {

/// The recordings of an archive but for one, weighed.
std::deque<RecordingOnDisk> others_in(const OwnFolder& archive, const OwnFolder& own,
                                      Stamp tolerance, const std::atomic<bool>& enough) {
  std::deque<RecordingOnDisk> recordings;
  archive.each_name([&](const std::string& name) {
    if (enough) return;
    const auto folder = archive.folder(name);
    if (!folder || folder->is_same_as(own)) return;
    auto recording = RecordingOnDisk::find(archive, name);
    if (!recording) return;
    recording->weigh(tolerance, enough);
    recording->close();
    recordings.push_back(std::move(*recording));
  });
  std::sort(recordings.begin(), recordings.end(),
            [](const auto& a, const auto& b) { return a.newest() < b.newest(); });
  return recordings;
}

}  // namespace

RecordingArchive::RecordingArchive(const std::optional<OwnFolder>& archive, const OwnFolder& own,
                                   RecordingOnDisk part, Stamp tolerance) {
  look_ = std::make_unique<Look>();
  look_->found = std::async(std::launch::async, [archive, own, tolerance, part = std::move(part),
                                                 &enough = look_->enough]() mutable {
    name_thread("archive");
    auto recordings =
        archive ? others_in(*archive, own, tolerance, enough) : std::deque<RecordingOnDisk>{};
    part.weigh(tolerance, enough);
    recordings.push_back(std::move(part));
    return recordings;
  });
}

bool RecordingArchive::is_known() {
  if (look_ == nullptr) return true;
  if (look_->found.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
  Recordings found = look_->found.get();
  look_.reset();
  for (RecordingOnDisk& recording : found) {
    take_note(recording);
    if (recording.bytes() == 0) continue;
    bytes_ += recording.bytes();
    recordings_.push_back(std::move(recording));
  }
  return true;
}

const RecordingOnDisk* RecordingArchive::earlier_part() const {
  return !recordings_.empty() && recordings_.back().is_part() ? &recordings_.back() : nullptr;
}

std::uint64_t RecordingArchive::delete_oldest_set() {
  return delete_oldest_set_of(recordings_.begin());
}

std::optional<std::uint64_t> RecordingArchive::delete_outdated_set(Stamp limit) {
  const auto outdated = std::find_if(recordings_.begin(), recordings_.end(), [&](const auto& r) {
    return r.dated() && r.oldest() < limit;
  });
  if (outdated == recordings_.end()) return std::nullopt;
  return delete_oldest_set_of(outdated);
}

std::uint64_t RecordingArchive::delete_oldest_set_of(Recordings::iterator recording) {
  const std::uint64_t before = recording->bytes();
  const std::uint64_t made = recording->delete_oldest_set();
  bytes_ -= before;
  bytes_ += recording->bytes();
  take_note(*recording);
  if (recording->bytes() == 0) recordings_.erase(recording);
  return made;
}

void RecordingArchive::take_note(RecordingOnDisk& recording) {
  if (std::string note = recording.take_note(); !note.empty()) notes_.push_back(std::move(note));
}

std::vector<std::string> RecordingArchive::take_notes() { return std::exchange(notes_, {}); }

}  // namespace waymark
