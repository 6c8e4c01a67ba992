#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/descriptor.h"
#include "core/base/error.h"
#include "core/geometry/stamp.h"
#include "drivers/frame.h"
#include "locd/record/frame_table.h"
#include "locd/record/own_folder.h"
#include "locd/record/recording_archive.h"

namespace waymark {

/// What a recording may take.
struct RecordingBudget {
  std::uint64_t max_bytes = 10'000'000'000;      ///< on the disk; older sets are deleted beyond
  Stamp keep = std::chrono::hours(7 * 24);       ///< older sets are deleted
  std::uint64_t min_free_bytes = 1'000'000'000;  ///< left free on the file system
};

/// What a recording says of itself besides its images.
struct RecordingFacts {
  std::string rig_yaml;
  std::string markers_toml;  ///< empty: none is written
  std::string session_id;
  std::string version;
  std::string codec;  ///< "pgm" or "jpeg"
  std::string name;   ///< behind the date in the name of a new folder; empty: none
  std::vector<std::string> cameras;
  Stamp sync_tolerance{0};
  bool date_known = false;  ///< the system vouches for its clock: stamps are dates
  /// Whose other recordings share the budget, and go first, oldest first; empty: there are none.
  std::filesystem::path archive;
};

/// One image on its way to disk.
struct RecordedImage {
  std::size_t camera = 0;
  FrameInfo info;          ///< its stamp becomes the file's name
  std::string_view bytes;  ///< encoded
};

/// What one set may have deleted: as much as it takes itself, for which it makes room, and as much
/// again of what is too much or too old. Whatever is wrong, a clock or a sum, costs no more.
class DeletionAllowance {
 public:
  explicit DeletionAllowance(std::uint64_t set_bytes) : bytes_(2 * set_bytes) {}
  [[nodiscard]] bool is_used_up() const { return deleted_ >= bytes_; }
  void take(std::uint64_t deleted) { deleted_ += deleted; }

 private:
  std::uint64_t bytes_;
  std::uint64_t deleted_ = 0;
};

/// A capture folder that grows at one end and is deleted at the other. Every file appears whole, by
/// rename; sync() makes what is there outlast a power cut. Whenever the process dies, what is there
/// is a capture that mapbuilder reads. What it deletes is locd's own (OwnFolder), and for its date
/// only what surely has one: sets of this run of locd, whose stamps are of one clock; others only
/// while the date is known, and where it was when they were recorded.
class RecordingFolder {
 public:
  /// Creates the folder, or goes on with one that locd recorded with the same rig. Errors:
  /// cant_create (another capture or something else is there, no place to write), permission, io.
  [[nodiscard]] static Expected<RecordingFolder> open(const std::filesystem::path& path,
                                                      const RecordingFacts& facts,
                                                      const RecordingBudget& budget);
  RecordingFolder(RecordingFolder&&) = default;
  RecordingFolder& operator=(RecordingFolder&&) = delete;

  /// Writes one frame set, after making room for it: nothing is deleted where that would not do.
  /// Sets that it makes outdated go once it is there. False: it is not written, for there is no
  /// room yet; each further set makes some. Errors: io (disk full, device gone, no room to be
  /// made); then nothing of the set is left behind.
  [[nodiscard]] Expected<bool> write_set(const std::vector<RecordedImage>& images);

  /// Notes in marks.csv, a row each, t_ns,text: what somebody remarked at that instant, on the
  /// clock of the images' names. Error: io.
  [[nodiscard]] Status mark(Stamp stamp, std::string_view text);

  /// Brings all that was written to the disk itself. Error: io.
  [[nodiscard]] Status sync();

  [[nodiscard]] const std::filesystem::path& path() const { return folder_.path(); }
  /// Whether it is known what was there before: until then nothing of that counts or is deleted.
  [[nodiscard]] bool knows_what_was_there() { return earlier_.is_known(); }
  /// On the disk, of images and their table, those of an earlier run of locd into it included.
  [[nodiscard]] std::uint64_t bytes() const;
  [[nodiscard]] std::uint64_t sets() const;
  void set_budget(const RecordingBudget& budget) { budget_ = budget; }
  /// Whether the system vouches for the clock now.
  void set_date_known(bool known) { date_known_ = known; }
  /// What can't be deleted, and why: a line each, told once.
  [[nodiscard]] std::vector<std::string> take_notes();

 private:
  struct ImageOnDisk {
    std::size_t camera;
    Stamp stamp;
  };
  struct SetOnDisk {
    Stamp stamp{0};
    std::uint64_t bytes = 0;
    std::vector<ImageOnDisk> images;
  };

  RecordingFolder(OwnFolder folder, const RecordingFacts& facts, const RecordingBudget& budget);
  [[nodiscard]] Status write_texts(const RecordingFacts& facts);
  [[nodiscard]] Status say_whether_date_is_known();
  [[nodiscard]] Status write_text(const char* name, const std::string& text);
  [[nodiscard]] Status open_folders();
  [[nodiscard]] Status look_at_earlier(const RecordingFacts& facts, bool part_is_dated);
  [[nodiscard]] Expected<std::uint64_t> free_bytes() const;
  [[nodiscard]] tl::unexpected<Error> no_room(std::uint64_t free_bytes) const;
  [[nodiscard]] Expected<bool> make_room(std::uint64_t bytes, DeletionAllowance& allowance);
  [[nodiscard]] Expected<bool> make_room_on_disk(std::uint64_t bytes, DeletionAllowance& allowance);
  /// That a deletion has made room. Error: io.
  [[nodiscard]] Status check_freed(std::uint64_t before, std::uint64_t deleted) const;
  /// Once a newer set is there: a kill in between would leave an empty capture.
  void delete_outdated(DeletionAllowance& allowance);
  [[nodiscard]] bool has_oldest() const { return !earlier_.empty() || !sets_.empty(); }
  std::uint64_t delete_oldest(DeletionAllowance& allowance);
  std::uint64_t delete_oldest_own();
  /// Has something deleted, and the table forget it at once: a kill may come before the next set.
  template <typename Delete>
  auto forgetting(const Delete& delete_something);
  std::uint64_t delete_set(const SetOnDisk& set);
  [[nodiscard]] Status write_image(const RecordedImage& image);
  [[nodiscard]] std::string rows_of(const std::vector<RecordedImage>& images) const;
  /// Keeps the table from listing more deleted images than kept ones.
  [[nodiscard]] Status forget_deleted_rows();
  [[nodiscard]] bool is_there(std::string_view camera, Stamp stamp) const;
  [[nodiscard]] std::uint64_t images() const;

  OwnFolder folder_;
  std::vector<std::string> cameras_;
  std::string codec_;
  std::string capture_toml_;
  RecordingBudget budget_;
  bool date_known_;
  bool says_date_known_ = false;    ///< in capture.toml
  bool may_say_date_known_ = true;  ///< nothing without a date is in it
  std::vector<OwnFolder> folders_;  ///< per camera
  std::vector<Descriptor> unsynced_;
  std::optional<FrameTable> table_;
  Descriptor marks_;  ///< marks.csv, once there is something in it
  RecordingArchive earlier_;
  std::deque<SetOnDisk> sets_;  ///< of this run
  std::uint64_t set_images_ = 0;
  std::uint64_t set_bytes_ = 0;
  std::uint64_t listed_ = 0;  ///< rows at least that are of images which are there
  std::string undeletable_;   ///< the first of this run's images that could not be deleted
  bool undeletable_told_ = false;
};

}  // namespace waymark
