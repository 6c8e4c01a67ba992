#pragma once

#include <optional>

#include "core/base/range.h"
#include "drivers/frame.h"

namespace waymark {

/// When a camera's stamps are not believed.
struct StampGuardOptions {
  Stamp delay{0};  ///< taken off every stamp: what the driver adds to mid-exposure
  Stamp future = std::chrono::milliseconds(2);  ///< later than now by more can't be (0–100 ms)
  int oldest_periods = 3;                       ///< older than so many can't be used (1–100)
  int distrust_after = 5;  ///< refused in a row: arrival times from now on (1–1000)
  int trust_after = 50;    ///< fine in a row: stamps again (1–10000)

  static constexpr Range kDelay_us{-1e6, 1e6};
  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Checks one camera's stamps: a stamp in the future, older than three periods, or that does not
/// rise is refused; when that goes on, the frame's arrival takes its place, flagged as such. Frames
/// that come in a burst because locd was late to fetch them are old for a good reason: they count
/// neither for nor against the stamps. Pure.
class StampGuard {
 public:
  /// The options are valid (checked).
  explicit StampGuard(const StampGuardOptions& options = {});

  /// Corrects the stamp of a frame that came at `arrival`; false: the frame is to be dropped.
  [[nodiscard]] bool admit(Frame& frame, Stamp arrival);

  /// Arrival times stand in for stamps.
  [[nodiscard]] bool unsynced() const { return unsynced_; }

 private:
  [[nodiscard]] bool believable(Stamp stamp, Stamp arrival) const;
  /// Whether the frame comes in a burst.
  [[nodiscard]] bool learn_period(Stamp arrival);

  StampGuardOptions options_;
  std::optional<Stamp> last_stamp_;   ///< of the last frame admitted
  std::optional<Stamp> last_device_;  ///< that the device gave last, corrected
  std::optional<Stamp> last_arrival_;
  Stamp period_{0};   ///< running mean of arrivals; 0: not known
  int in_a_row_ = 0;  ///< refused ones, or, when unsynced, fine ones
  bool unsynced_ = false;
};

}  // namespace waymark
