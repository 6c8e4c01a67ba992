#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/geometry/stamp.h"

namespace waymark {

/// Thins frame sets evenly when the machine can't localize all of them: every 2nd, every 3rd … set
/// is taken, instead of whichever happens to find the solver idle. Pure; for one thread.
class SetPacer {
 public:
  /// Judged by so many sets: their 98th percentile, so that one hiccup in them changes nothing.
  static constexpr std::size_t kWindow = 64;
  /// Solving may fill this part of the time between the sets taken; beyond it sets would wait.
  static constexpr double kBusy = 0.95;
  /// A smaller divisor is tried when it would fill no more than this: the gap keeps the pace from
  /// swinging.
  static constexpr double kIdle = 0.75;
  static constexpr int kMaxDivisor = 10;

  /// A set arrived: whether to take it.
  [[nodiscard]] bool admit(Stamp set_stamp);
  /// A taken set was done after `duration`.
  void finished(Stamp duration);

  /// Every divisor-th set is taken.
  [[nodiscard]] int divisor() const { return divisor_; }
  /// Sets not taken so far.
  [[nodiscard]] std::uint64_t skipped() const { return skipped_; }

 private:
  void judge();

  int divisor_ = 1;
  int since_taken_ = 0;
  std::uint64_t skipped_ = 0;
  bool has_last_ = false;
  Stamp last_{0};
  Stamp period_{0};  ///< between arriving sets, smoothed
  std::array<Stamp, kWindow> durations_{};
  std::size_t count_ = 0;  ///< durations since the last change of pace
};

}  // namespace waymark
