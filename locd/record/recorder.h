#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/priority_mutex.h"
#include "core/base/range.h"
#include "locd/frames/frame_synchronizer.h"
#include "locd/record/recording_folder.h"

namespace waymark {

/// How frame sets are recorded.
struct RecorderOptions {
  bool jpeg = false;
  int jpeg_quality = 95;
  int every_nth = 1;  ///< one of so many frame sets
  RecordingBudget budget;
  /// Pixels of each camera's image, so that memory is there before the first set comes.
  std::vector<std::size_t> pixels;

  static constexpr Range kJpegQuality{1, 100};
  static constexpr Range kEveryNth{1, 1'000'000};
  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Records frame sets as captures. All disk access is done in a thread of its own, from creating
/// the folder to the last sync. offer() costs its caller one copy of the pixels and never waits:
/// when no slot is free because all are still being written, the set is dropped and counted.
class Recorder {
 public:
  /// Sets under way at most: what a disk that stalls for a tenth of a second holds up at 30 Hz.
  static constexpr std::size_t kSlots = 4;
  static constexpr Stamp kSyncPeriod = std::chrono::seconds(1);

  Recorder() = default;
  /// Ends the recording and waits for it.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  enum class Phase { idle, starting, recording, stopping };

  /// Has a recording begin in `folder`, or, where that is empty, in a new one of the facts'
  /// archive; state() tells when it did, or why not. Only when idle, with valid options (checked).
  void start(const std::filesystem::path& folder, const RecordingFacts& facts,
             const RecorderOptions& options);
  /// Has it end, with all that was taken on the disk; state() tells when.
  void stop();
  /// What the recording may take from its next set on.
  void set_budget(const RecordingBudget& budget);
  /// Whether the system vouches for the clock now.
  void set_date_known(bool known) { date_known_ = known; }
  /// Has what somebody remarks noted in the recording (RecordingFolder::mark). False: nothing is
  /// recorded, or kMostMarks wait to be written.
  [[nodiscard]] bool mark(Stamp stamp, std::string text);
  static constexpr std::size_t kMostMarks = 64;
  /// Waits while it starts or stops; false when it still does at `deadline`.
  [[nodiscard]] bool settle(Stamp deadline) const;

  /// Takes every nth set's images; without a recording, nothing happens. `utime_offset` makes of
  /// their stamps the dates in their names: what made the set's utime. Any one thread.
  void offer(const FrameSetLease& set, Stamp utime_offset);

  struct State {
    Phase phase = Phase::idle;
    std::filesystem::path folder;  ///< of the last recording; empty when it did not begin
    std::uint64_t begun = 0;       ///< recordings since the start of the program
    std::uint64_t sets = 0;        ///< in the folder
    std::uint64_t bytes = 0;       ///< in the folder
    std::uint64_t drops = 0;       ///< sets not written since the start of the program
    std::optional<Error> failure;  ///< that ended the last recording, or kept it from beginning
    /// Whether the folder still grows.
    [[nodiscard]] bool running() const { return phase != Phase::idle && !folder.empty(); }
  };
  [[nodiscard]] State state() const;
  /// What of earlier recordings can't be deleted, and why: a line each, told once.
  [[nodiscard]] std::vector<std::string> take_notes();

 private:
  struct Image {
    FrameInfo info;
    int width_px = 0;
    int height_px = 0;
    std::vector<std::uint8_t> pixels;  ///< rows without padding
  };
  struct Slot {
    CameraMask cameras = 0;
    Stamp utime_offset{0};
    std::vector<Image> images;  ///< per camera
  };

  /// The thread, from a recording's beginning to its end.
  void run(const std::filesystem::path& folder, const RecordingFacts& facts);
  void begin(const RecordingFolder& folder, std::size_t cameras);
  [[nodiscard]] Status record(RecordingFolder& folder);
  void end(const Status& how);
  /// The next set to write: nullopt when a sync is due or, as `done` tells, none will come.
  [[nodiscard]] std::optional<std::size_t> next_filled_slot(Stamp sync_due, bool& done);
  /// False: there is no room for it yet.
  [[nodiscard]] Expected<bool> write(RecordingFolder& folder, const Slot& slot);
  [[nodiscard]] Status adopt_news(RecordingFolder& folder);
  void publish_state(RecordingFolder& folder);
  [[nodiscard]] std::optional<std::size_t> take_free_slot();
  static void copy(const FrameSetLease& set, Slot& slot);

  RecorderOptions options_;
  mutable PriorityMutex mutex_;  ///< of everything below but the slots' content
  mutable PriorityCondition changed_;
  std::vector<Slot> slots_;
  std::vector<std::size_t> free_;
  std::vector<std::size_t> filled_;  ///< oldest first; never longer than its capacity
  std::optional<RecordingBudget> next_budget_;
  std::vector<std::pair<Stamp, std::string>> marks_;  ///< to be written
  bool stopping_ = false;
  std::uint64_t offered_ = 0;
  State state_;
  std::vector<std::string> notes_;
  std::atomic<bool> date_known_{false};
  std::vector<std::string> encoded_;  ///< the recorder's thread only
  std::thread thread_;
};

}  // namespace waymark
