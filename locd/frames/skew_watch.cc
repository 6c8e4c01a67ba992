#include "locd/frames/skew_watch.h"

#include "core/base/check.h"

namespace waymark {

Status SkewWatchOptions::check() const {
  return RangeCheck()
      .field("most in ms", in_us(most) / 1e3, kMost_ms)
      .field("sets", sets, {2, 100})
      .status();
}

SkewWatch::SkewWatch(const SkewWatchOptions& options) : options_(options) {
  WAYMARK_CHECK(options.check().has_value());
}

void SkewWatch::look(Stamp set_stamp, Stamp skew, std::vector<Alert>& alerts) {
  if (!options_.triggered) return;
  const bool skewed = skew > options_.most;
  sets_otherwise_ = skewed == raised_ ? 0 : sets_otherwise_ + 1;
  if (sets_otherwise_ < options_.sets) return;
  raised_ = skewed;
  sets_otherwise_ = 0;
  Alert alert;
  alert.kind = AlertKind::stamps_skewed;
  alert.raised = raised_;
  alert.stamp = set_stamp;
  alerts.push_back(alert);
}

}  // namespace waymark
