#pragma once

#include <cstdint>

#include "core/geometry/stamp.h"

namespace waymark {

/// The machine's clocks at one instant.
struct ClockReading {
  Stamp monotonic{0};        ///< CLOCK_MONOTONIC, the clock of stamps; stands still while suspended
  Stamp boottime{0};         ///< CLOCK_BOOTTIME: the same, but runs while suspended
  Stamp wall{0};             ///< CLOCK_REALTIME, since the epoch
  bool vouched_for = false;  ///< a time service has set the wall clock and keeps it
};

/// Reads the three clocks as of one instant, as well as the scheduler lets it (tens of µs).
[[nodiscard]] ClockReading read_clocks();

/// How far utime can be taken for the machine's wall clock. Values are those of status_t.
enum class TimeStatus : std::int8_t {
  ok = 0,         ///< within 1 ms
  slewing = 1,    ///< catching up with a clock that itself is slewed
  stepped = 2,    ///< the wall clock was set; utime approaches it slowly
  suspended = 3,  ///< the machine slept; utime approaches it slowly
  unset = 4,      ///< the wall clock stood before 2020 at the start: utime is no date
};

/// What has happened to the machine's clocks between two readings.
enum class ClockEvent {
  none,
  stepped,  ///< the wall clock was set
  slept,    ///< the machine was suspended: CLOCK_MONOTONIC stood still, the vehicle may not have
};

/// Turns stamps into utime: stamp + offset. The offset is taken from the wall clock once and from
/// then on follows it by at most 500 ppm, so that a step of the wall clock, a suspend or a clock
/// that gets its date late never bends an interval between two poses by more than that. Pure; not
/// for several threads at once.
class ClockOffset {
 public:
  static constexpr double kMaxSlew_ppm = 500;
  /// Farther from the wall clock than this, utime counts as another clock's (1 ms: a vehicle at
  /// 2 m/s moves 2 mm).
  static constexpr Stamp kTolerance = std::chrono::milliseconds(1);
  /// A change of wall − monotonic between two readings beyond this, plus kMaxDrift_ppm of the time
  /// between, is a step: no disciplined clock moves so.
  static constexpr Stamp kStep = std::chrono::milliseconds(5);
  static constexpr double kMaxDrift_ppm = 1000;
  /// Closer to a wall clock that is vouched for, utime is a date: what is kept for days is judged
  /// by it.
  static constexpr Stamp kDateTolerance = std::chrono::minutes(1);
  /// 2020-01-01: an earlier date is a clock without battery, not a date.
  static constexpr Stamp kEarliestDate = std::chrono::seconds(1'577'836'800);

  explicit ClockOffset(const ClockReading& start);

  /// Of the time between two readings, at most so much is slewed for: after a gap the offset does
  /// not move by more than 0.1 ms at once, which is less than lies between two frame sets.
  static constexpr Stamp kLongestSlew = std::chrono::milliseconds(200);

  /// Follows the clocks; call several times a second.
  ClockEvent update(const ClockReading& now);

  /// µs since the epoch of an instant on CLOCK_MONOTONIC. Never falls while stamps rise by 0.1 ms
  /// or more.
  [[nodiscard]] std::int64_t utime_us(Stamp stamp) const;
  /// What utime adds to a stamp.
  [[nodiscard]] Stamp offset() const { return offset_; }
  [[nodiscard]] TimeStatus status() const { return status_; }
  /// Steps of the wall clock so far, suspends included.
  [[nodiscard]] int steps() const { return steps_; }
  /// Wall clock minus utime.
  [[nodiscard]] Stamp error() const;
  /// Whether utime surely is the date, now and of all this session's stamps.
  [[nodiscard]] bool date_known() const;

 private:
  ClockReading last_;
  Stamp offset_;
  TimeStatus status_;
  int steps_ = 0;
};

}  // namespace waymark
