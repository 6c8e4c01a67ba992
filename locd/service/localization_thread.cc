#include "locd/service/localization_thread.h"

#include "drivers/monotonic_clock.h"
#include "locd/frames/realtime.h"

namespace waymark {
namespace {

/// The thread turns at least this often.
constexpr Stamp kTurn = std::chrono::milliseconds(100);

}  // namespace

LocalizationThread::LocalizationThread(RigCapture& capture, Telemetry& telemetry, MapInUse map,
                                       std::function<void(const FrameSetLease&, Stamp)> after_set)
    : capture_(capture),
      telemetry_(telemetry),
      after_set_(std::move(after_set)),
      map_(std::move(map)) {
  alerts_.reserve(kMaxAlerts);
}

LocalizationThread::~LocalizationThread() { stop(); }

void LocalizationThread::start(bool realtime) {
  stopping_ = false;
  thread_ = std::thread([this, realtime] {
    name_thread("localization");
    // The start of the program has found out whether it may.
    if (realtime) static_cast<void>(make_realtime(kLocalizationPriority));
    run();
  });
}

void LocalizationThread::stop() {
  stopping_ = true;
  if (thread_.joinable()) thread_.join();
}

void LocalizationThread::run() {
  while (!stopping_) {
    auto set = capture_.wait(monotonic_now() + kTurn);
    adopt_next_map();
    utime_offset_.reset();
    if (set) begin_work();
    const bool localized = set && pacer_.admit(set->mean_stamp()) && localize(*set);
    leave_word(set.has_value(), localized);
    if (set) after_set_(*set, utime_offset_ ? *utime_offset_ : telemetry_.utime_offset());
  }
}

bool LocalizationThread::localize(const FrameSetLease& set) {
  const Stamp begun = monotonic_now();
  if (begun - set.mean_stamp() > map_.time_budget) {
    lose(set, PoseReason::overload);
    utime_offset_ = telemetry_.publish_pose(estimate_, begun);
    const std::lock_guard lock(mutex_);
    ++counts_.late;
    return false;
  }
  if (map_.localizer != nullptr) {
    if (forget_motion_.exchange(false)) map_.localizer->forget_motion();
    map_.localizer->localize(set, estimate_);
  } else {
    lose(set, PoseReason::no_map);
  }
  const Stamp done = monotonic_now();
  utime_offset_ = telemetry_.publish_pose(estimate_, done);
  pacer_.finished(done - begun);
  return true;
}

void LocalizationThread::lose(const FrameSetLease& set, PoseReason why) {
  estimate_.lose(why);
  estimate_.stamp = set.mean_stamp();
  estimate_.cameras_in_set = set.cameras;
  estimate_.max_skew = set.max_skew();
}

void LocalizationThread::adopt_next_map() {
  const std::lock_guard lock(mutex_);
  if (!next_map_) return;
  replaced_map_ = std::move(map_);
  map_ = std::move(*next_map_);
  next_map_.reset();
  telemetry_.set_map(map_.map_hash, map_.world_z_is_up);
}

void LocalizationThread::begin_work() {
  const std::lock_guard lock(mutex_);
  ++counts_.sets;
  counts_.at_work = true;
}

void LocalizationThread::leave_word(bool took_set, bool localized) {
  const std::lock_guard lock(mutex_);
  counts_.last_turn = monotonic_now();
  counts_.at_work = false;
  if (took_set && !localized) counts_.passed_over = counts_.last_turn;
  counts_.divisor = pacer_.divisor();
  counts_.skipped = pacer_.skipped();
  if (!localized || map_.localizer == nullptr) return;
  counts_.unhealthy = map_.localizer->unhealthy_cameras();
  for (const Alert& alert : map_.localizer->alerts()) {
    if (alerts_.size() < kMaxAlerts) {
      alerts_.push_back(alert);
    } else {
      ++counts_.alerts_lost;
    }
  }
  if (map_.localizer->quarantine_changed()) quarantine_ = map_.localizer->quarantine();
}

void LocalizationThread::swap_map(MapInUse next) {
  std::optional<MapInUse> replaced;
  const std::lock_guard lock(mutex_);
  replaced.swap(replaced_map_);
  next_map_ = std::move(next);
}

std::vector<Alert> LocalizationThread::take_alerts() {
  std::optional<MapInUse> replaced;
  std::vector<Alert> taken;
  taken.reserve(kMaxAlerts);
  const std::lock_guard lock(mutex_);
  replaced.swap(replaced_map_);
  taken.swap(alerts_);
  return taken;
}

std::optional<std::vector<QuarantinedMarker>> LocalizationThread::take_quarantine() {
  std::optional<std::vector<QuarantinedMarker>> taken;
  const std::lock_guard lock(mutex_);
  taken.swap(quarantine_);
  return taken;
}

LocalizationCounts LocalizationThread::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

}  // namespace waymark
