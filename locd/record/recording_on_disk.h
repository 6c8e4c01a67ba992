#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/stamp.h"
#include "locd/record/own_folder.h"

namespace waymark {

/// How the line of capture.toml begins by which locd knows its own recordings.
inline constexpr const char* kRecordedByLocd = "software = \"waymark locd ";
/// The line by which a recording says that its stamps are dates: the system vouched for its clock.
inline constexpr const char* kDateKnown = "date_known = true\n";
inline constexpr const char* kDateNotKnown = "date_known = false\n";

/// Whether locd recorded what lies in `capture`. What it did not record it neither goes on with nor
/// deletes.
[[nodiscard]] bool recorded_by_locd(const OwnFolder& capture);
[[nodiscard]] bool date_known(const OwnFolder& capture);

/// What was recorded earlier, as it lies on the disk: what of it may be deleted, and how its sets
/// go, the oldest first, until nothing of it is left.
class RecordingOnDisk {
 public:
  /// The recording in the folder `name`; nullopt: locd did not record what is there.
  [[nodiscard]] static std::optional<RecordingOnDisk> find(const OwnFolder& archive,
                                                           const std::string& name);
  /// What a recording that goes on holds already; `dated`: its stamps are dates. Its texts stay.
  [[nodiscard]] static RecordingOnDisk earlier_part_of(const OwnFolder& recording, bool dated);

  /// Asks the disk for the size of every image, whatever its codec; gives up when `enough`. Before,
  /// nothing counts and nothing may be deleted. Images within `tolerance` are a set.
  void weigh(Stamp tolerance, const std::atomic<bool>& enough);
  /// Closes its folders until something is deleted of it. Not for a part, which grows meanwhile.
  void close() { opened_.reset(); }

  [[nodiscard]] bool is_part() const { return is_part_; }
  /// On the disk, of what may be deleted. 0: nothing may be, or all is.
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  [[nodiscard]] std::uint64_t images() const { return images_; }
  [[nodiscard]] std::uint64_t sets() const { return sets_; }
  [[nodiscard]] Stamp oldest() const { return oldest_; }
  [[nodiscard]] Stamp newest() const { return newest_; }
  /// Whether its stamps are dates.
  [[nodiscard]] bool dated() const { return dated_; }
  /// What can't be deleted of it, and why; empty: nothing. Once.
  [[nodiscard]] std::string take_note();

  /// Deletes the images of its oldest set, and what is left with the last; gives what that gave
  /// back. What can't be deleted is passed over, and counts no more.
  std::uint64_t delete_oldest_set();

 private:
  struct Image {
    Stamp stamp;
    std::string camera;
    std::string name;
  };
  struct Opened {
    OwnFolder folder;
    std::map<std::string, OwnFolder> cameras;
    std::deque<Image> images;  ///< by rising stamp
  };
  struct Kept {
    std::uint64_t files = 0;
    std::string first;  ///< which, and why
  };

  RecordingOnDisk(OwnFolder archive, std::string name);
  [[nodiscard]] static Opened list(const OwnFolder& folder);
  [[nodiscard]] bool reopen();
  void count(const Expected<std::uint64_t>& bytes);
  [[nodiscard]] std::uint64_t remove(const OwnFolder& folder, const std::string& file);
  [[nodiscard]] std::uint64_t remove_the_rest();
  void forget();

  OwnFolder archive_;
  std::string name_;
  bool is_part_ = false;
  bool dated_ = false;
  Stamp tolerance_{0};
  std::uint64_t bytes_ = 0;
  std::uint64_t images_ = 0;
  std::uint64_t sets_ = 0;
  Stamp oldest_{0};
  Stamp newest_{0};
  Kept kept_;
  bool told_ = false;
  std::optional<Opened> opened_;  ///< while it is weighed, and while it is being deleted
};

}  // namespace waymark
