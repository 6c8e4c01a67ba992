#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/stamp.h"
#include "locd/record/own_folder.h"
#include "locd/record/recording_on_disk.h"

namespace waymark {

/// Creates a folder for another recording, named by the date (UTC) so that names sort by age, and
/// behind it `name`, where that is not empty. Errors: cant_create, permission.
[[nodiscard]] Expected<std::filesystem::path> new_recording_folder(
    const std::filesystem::path& archive, const std::string& name = "");

/// Whether recordings can go to an archive that may have to be made: config where a part of its
/// path is no folder or can't be one. A note where this process (which need not be the service's
/// user) may not write there.
[[nodiscard]] Expected<std::optional<std::string>> check_archive(
    const std::filesystem::path& archive);

/// What was recorded earlier and shares a budget with the recording that is being made: the other
/// recordings of its archive, that whose newest image is oldest first, and then what its own folder
/// held before. It is looked through in a thread of its own, for that takes long where much lies on
/// a slow disk; until then nothing of it is deleted.
class RecordingArchive {
 public:
  /// One without recordings.
  RecordingArchive() = default;
  /// `archive`: the folder of others; nullopt: there are none. `part`: what the folder of the
  /// recording that is being made, `own`, holds already. Images within `tolerance` are a set. What
  /// can't be listed is left alone.
  RecordingArchive(const std::optional<OwnFolder>& archive, const OwnFolder& own,
                   RecordingOnDisk part, Stamp tolerance);

  /// Whether all of it has been looked at. Waits for nothing.
  [[nodiscard]] bool is_known();

  // Nothing, until it is known:

  /// On the disk, of what may be deleted.
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  [[nodiscard]] bool empty() const { return recordings_.empty(); }
  /// What is left of what the own folder held before; nullptr: nothing.
  [[nodiscard]] const RecordingOnDisk* earlier_part() const;
  /// Deletes the set that goes first; gives what that gave back.
  std::uint64_t delete_oldest_set();
  /// Deletes a set that is older than `limit`, of recordings whose stamps are dates; nullopt: there
  /// is none.
  std::optional<std::uint64_t> delete_outdated_set(Stamp limit);
  /// What can't be deleted, and why: a line per recording, each told once.
  [[nodiscard]] std::vector<std::string> take_notes();

 private:
  using Recordings = std::deque<RecordingOnDisk>;
  /// The thread that looks; ended by its destructor.
  struct Look {
    std::atomic<bool> enough{false};
    std::future<Recordings> found;
    Look() = default;
    Look(const Look&) = delete;
    Look& operator=(const Look&) = delete;
    ~Look() { enough = true; }
  };
  std::uint64_t delete_oldest_set_of(Recordings::iterator recording);
  void take_note(RecordingOnDisk& recording);

  std::unique_ptr<Look> look_;
  Recordings recordings_;  ///< the one that goes first, first
  std::uint64_t bytes_ = 0;
  std::vector<std::string> notes_;
};

}  // namespace waymark
