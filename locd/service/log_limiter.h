#pragma once

#include <map>
#include <optional>
#include <string>

#include "core/geometry/stamp.h"

namespace waymark {

/// Keeps the log readable when something happens again and again: the first occurrence is a line of
/// its own, all that follow are counted, and once a minute one line sums up what was counted, of
/// all subjects together. A subject is what happens and to whom, without figures: those differ each
/// time. Pure; times are of CLOCK_MONOTONIC.
class LogLimiter {
 public:
  static constexpr Stamp kSummaryPeriod = std::chrono::minutes(1);
  /// What has not happened for this long is news again.
  static constexpr Stamp kForget = std::chrono::minutes(10);
  /// First occurrences that get a line within an hour; those beyond are counted, too.
  static constexpr int kMaxFirst = 100;

  /// `what` ("cam1 MISSING") happened: whether it deserves a line now.
  [[nodiscard]] bool admit(const std::string& what, Stamp now);

  /// Subjects that are remembered.
  [[nodiscard]] std::size_t subjects() const { return subjects_.size(); }

  /// The minute's summary, when it is due and something was counted.
  [[nodiscard]] std::optional<std::string> summary(Stamp now);

 private:
  struct Subject {
    Stamp last{0};
    int counted = 0;
  };
  std::map<std::string, Subject> subjects_;
  std::optional<Stamp> summary_due_;
  Stamp hour_began_{0};
  int first_in_hour_ = 0;
};

}  // namespace waymark
