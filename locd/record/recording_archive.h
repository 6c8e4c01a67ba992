#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>

#include "core/base/error.h"
#include "core/geometry/stamp.h"

namespace waymark {

/// How the line of capture.toml begins by which locd knows its own recordings.
inline constexpr const char* kRecordedByLocd = "software = \"waymark locd ";

/// Whether locd recorded what lies in `capture`. What it did not record it neither goes on with nor
/// deletes.
[[nodiscard]] bool recorded_by_locd(const std::filesystem::path& capture);

/// Creates a folder for another recording, named by the date (UTC) so that names sort by age.
/// Errors: cant_create, permission.
[[nodiscard]] Expected<std::filesystem::path> new_recording_folder(
    const std::filesystem::path& archive);

/// The other recordings of a folder, which share a budget with the one that is being made: the one
/// whose newest image is oldest goes first.
class RecordingArchive {
 public:
  RecordingArchive() = default;
  /// Recordings in `folder` but for `own`; what can't be listed is left alone.
  RecordingArchive(const std::filesystem::path& folder, const std::filesystem::path& own);

  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  [[nodiscard]] bool empty() const { return recordings_.empty(); }
  /// Of the newest image of the recording that goes first.
  [[nodiscard]] Stamp oldest() const { return recordings_.front().newest; }
  /// Deletes the recording that goes first.
  void delete_oldest();

 private:
  struct Recording {
    std::filesystem::path path;
    std::uint64_t bytes = 0;
    Stamp newest{0};
  };
  [[nodiscard]] static Recording weigh(const std::filesystem::path& path);

  std::deque<Recording> recordings_;
  std::uint64_t bytes_ = 0;
};

}  // namespace waymark
