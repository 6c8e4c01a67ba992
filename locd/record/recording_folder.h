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
#include "locd/record/recording_archive.h"

namespace waymark {

/// What a recording may take.
struct RecordingBudget {
  std::uint64_t max_bytes = 10'000'000'000;  ///< of images and table; older sets are deleted beyond
  Stamp keep = std::chrono::hours(7 * 24);   ///< older sets are deleted
  std::uint64_t min_free_bytes = 1'000'000'000;  ///< left free on the file system
};

/// What a recording says of itself besides its images.
struct RecordingFacts {
  std::string rig_yaml;
  std::string markers_toml;  ///< empty: none is written
  std::string session_id;
  std::string version;
  std::string codec;  ///< "pgm" or "jpeg"
  std::vector<std::string> cameras;
  Stamp sync_tolerance{0};
  /// Whose other recordings share the budget, and go first, oldest first; empty: there are none.
  std::filesystem::path archive;
};

/// One image on its way to disk.
struct RecordedImage {
  std::size_t camera = 0;
  FrameInfo info;          ///< its stamp becomes the file's name
  std::string_view bytes;  ///< encoded
};

/// A capture folder that grows at one end and is deleted at the other. Every file appears whole, by
/// rename; sync() makes what is there outlast a power cut. Whenever the process dies, what is there
/// is a capture that mapbuilder reads.
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
  /// Sets that it makes outdated go once it is there. Errors: io (disk full, device gone, no room
  /// to be made); then nothing of the set is left behind.
  [[nodiscard]] Status write_set(const std::vector<RecordedImage>& images);

  /// Brings all that was written to the disk itself. Error: io.
  [[nodiscard]] Status sync();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Of the images and their table, those of an earlier run of locd into it included.
  [[nodiscard]] std::uint64_t bytes() const { return image_bytes_ + table_->bytes(); }
  [[nodiscard]] std::uint64_t sets() const { return sets_.size(); }
  void set_budget(const RecordingBudget& budget) { budget_ = budget; }

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

  explicit RecordingFolder(std::filesystem::path path, const RecordingFacts& facts,
                           const RecordingBudget& budget);
  [[nodiscard]] Status write_texts(const RecordingFacts& facts);
  [[nodiscard]] Status open_folders();
  void list_earlier_sets(Stamp tolerance);
  [[nodiscard]] Expected<std::uint64_t> free_bytes() const;
  [[nodiscard]] tl::unexpected<Error> no_room(std::uint64_t free_bytes) const;
  [[nodiscard]] Status make_room(std::uint64_t bytes);
  /// Once a newer set is there: a kill in between would leave an empty capture.
  void delete_outdated();
  [[nodiscard]] bool has_oldest() const { return !earlier_.empty() || !sets_.empty(); }
  [[nodiscard]] Stamp oldest() const {
    return earlier_.empty() ? sets_.front().stamp : earlier_.oldest();
  }
  void delete_oldest();
  void delete_set(const SetOnDisk& set);
  [[nodiscard]] Status write_image(const RecordedImage& image);
  [[nodiscard]] std::string rows_of(const std::vector<RecordedImage>& images) const;
  /// Keeps the table from listing more deleted images than kept ones.
  [[nodiscard]] Status forget_deleted_rows();
  [[nodiscard]] std::string file_name(Stamp stamp) const;

  std::filesystem::path path_;
  std::vector<std::string> cameras_;
  std::string ending_;
  RecordingBudget budget_;
  std::vector<Descriptor> folders_;  ///< per camera
  std::vector<Descriptor> unsynced_;
  std::optional<FrameTable> table_;
  RecordingArchive earlier_;
  std::deque<SetOnDisk> sets_;
  std::uint64_t images_ = 0;    ///< in sets_
  std::uint64_t unlisted_ = 0;  ///< of them at most: without a row, for a kill came before it
  std::uint64_t image_bytes_ = 0;
};

}  // namespace waymark
