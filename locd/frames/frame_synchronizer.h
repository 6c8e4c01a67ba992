#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/base/range.h"
#include "core/capture/frame_set.h"
#include "drivers/frame.h"
#include "locd/camera_mask.h"

namespace waymark {

/// How frames become frame sets.
struct SyncOptions {
  /// Frames this far after a set's earliest still belong to it. Triggered rigs: the jitter of their
  /// stamps. Free-running ones: at least (n − 1)/n of the period, then any phase gives sets.
  Stamp tolerance = std::chrono::milliseconds(5);
  /// From the arrival of a set's first frame until it goes without those that are missing. More
  /// than the cameras' differences in exposure time and transfer, less than a period.
  Stamp deadline = std::chrono::milliseconds(25);
  int min_cameras = 1;  ///< smaller sets are dropped
  /// A camera that misses so many sets in a row is not waited for until it delivers again; 0:
  /// always wait.
  int leave_after_sets = 3;

  static constexpr Range kTolerance_us = kSyncTolerance_us;
  static constexpr Range kDeadline_ms{1, 10'000};
  static constexpr Range kMinCameras{1, kMaxCameras};
  static constexpr Range kLeaveAfterSets{0, 1000};
  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Why a frame came into no set, or its set to no pose.
enum class DropReason : std::uint8_t {
  mismatched = 0,   ///< the oldest of frames that don't belong together
  overtaken = 1,    ///< a newer frame of its camera came before the set was complete
  late = 2,         ///< its set had gone already
  too_few = 3,      ///< its set has fewer than min_cameras
  bad_stamp = 4,    ///< its stamp lies in the future, too far back, or does not rise
  unhealthy = 5,    ///< frozen, stale, dark, saturated, obscured
  solver_busy = 6,  ///< a newer set came before the solver was free
  unsearched = 7,   ///< the library that finds markers failed on it
};
inline constexpr std::size_t kDropReasons = 8;
[[nodiscard]] const char* name_of(DropReason reason);

/// Counts per reason, one block per camera.
using DropCounts = std::array<std::uint64_t, kDropReasons>;

/// Frames of one instant. Moves with its leases; destroying it gives the buffers back.
struct FrameSetLease {
  std::uint64_t sequence = 0;
  CameraMask cameras = 0;   ///< that have a frame here
  CameraMask expected = 0;  ///< of the rig
  std::array<Frame, kMaxCameras> frames;

  [[nodiscard]] bool has(std::size_t camera) const { return (cameras & camera_bit(camera)) != 0; }
  /// Stamp of the lowest-numbered camera's frame, FORMATS' stamp of the set; 0 of an empty set.
  [[nodiscard]] Stamp set_stamp() const;
  /// Mean of the frames' stamps; 0 of an empty set.
  [[nodiscard]] Stamp mean_stamp() const;
  /// Latest less earliest stamp.
  [[nodiscard]] Stamp max_skew() const;
};

/// Makes frame sets of frames by their (corrected) stamps. Pure logic: time comes in as a number.
/// Holds one frame per camera. A set goes as soon as every camera that is waited for has a frame
/// within the tolerance of the earliest; when all have one and they don't agree, only the oldest
/// frame goes; when the deadline passes, what belongs to the earliest goes as a partial set.
/// No allocation. Not for several threads.
class FrameSynchronizer {
 public:
  /// At most kMaxCameras; the options are valid (checked).
  FrameSynchronizer(std::size_t cameras, const SyncOptions& options);

  /// Takes a camera's next frame at `now`.
  void push(std::size_t camera, Frame frame, Stamp now);

  /// The next set that is ready at `now`; to be called after every push and at next_deadline, until
  /// nullopt.
  [[nodiscard]] std::optional<FrameSetLease> take(Stamp now);

  /// When the frames held become a partial set; nullopt: none are held.
  [[nodiscard]] std::optional<Stamp> next_deadline() const;

  /// Cameras that sets wait for.
  [[nodiscard]] CameraMask quorum() const;
  [[nodiscard]] const DropCounts& dropped(std::size_t camera) const {
    return slots_[camera].dropped;
  }
  [[nodiscard]] std::uint64_t sets() const { return sequence_; }

 private:
  struct Slot {
    std::optional<Frame> frame;
    Stamp arrived{0};
    /// Its frames up to here are late: the last one that went in a set, or, where a set went
    /// without this camera, all that belonged to that.
    std::optional<Stamp> gone_until;
    int missed_sets = 0;
    DropCounts dropped{};
  };

  [[nodiscard]] std::optional<std::size_t> earliest() const;
  [[nodiscard]] CameraMask belonging_to(Stamp earliest) const;
  [[nodiscard]] CameraMask held() const;
  [[nodiscard]] std::optional<FrameSetLease> emit(CameraMask cameras);
  void drop(Slot& slot, DropReason reason);

  std::size_t cameras_;
  SyncOptions options_;
  std::array<Slot, kMaxCameras> slots_;
  std::uint64_t sequence_ = 0;
};

}  // namespace waymark
