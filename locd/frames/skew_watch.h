#pragma once

#include <vector>

#include "core/base/range.h"
#include "locd/alert.h"

namespace waymark {

/// When the cameras of a triggered rig count as not exposing together.
struct SkewWatchOptions {
  bool triggered = false;  ///< else exposures at different instants are as they should be
  /// Largest distance of exposures in a set.
  Stamp most = std::chrono::microseconds(1000);
  /// Sets in a row that raise the alert, or end it: one late interrupt is no broken trigger.
  /// (2–100)
  int sets = 10;

  static constexpr Range kMost_ms{0, 100};
  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Tells when a triggered rig's cameras no longer expose together, and when they do again.
class SkewWatch {
 public:
  /// The options are valid (checked).
  explicit SkewWatch(const SkewWatchOptions& options);

  /// Looks at a set's skew; appends an alert when it begins or ends. Allocates nothing while
  /// `alerts` has room.
  void look(Stamp set_stamp, Stamp skew, std::vector<Alert>& alerts);

 private:
  SkewWatchOptions options_;
  bool raised_ = false;
  int sets_otherwise_ = 0;  ///< in a row, that speak against `raised_`
};

}  // namespace waymark
