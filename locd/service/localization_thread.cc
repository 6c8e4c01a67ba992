#include "locd/service/localization_thread.h"

#include <algorithm>
#include <utility>

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
      in_use_(with_memory(std::move(map))) {
  ignored_.reserve(Localizer::kMostOrders);
  ignored_in_use_.reserve(Localizer::kMostOrders);
  to_release_.reserve(Localizer::kMostOrders);
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
    adopt_orders();
    utime_offset_.reset();
    if (set) begin_work();
    const bool localized = set && pacer_.admit(set->mean_stamp()) && localize(*set);
    finish_turn(set.has_value(), localized);
    if (set) after_set_(*set, utime_offset_ ? *utime_offset_ : telemetry_.utime_offset());
  }
}

bool LocalizationThread::localize(const FrameSetLease& set) {
  const MapInUse& map = in_use_.map;
  const Stamp begun = monotonic_now();
  if (begun - set.mean_stamp() > map.time_budget) {
    estimate_.reset(PoseReason::overload, set);
    utime_offset_ = telemetry_.publish_pose(estimate_, begun);
    const std::lock_guard lock(mutex_);
    ++counts_.late;
    return false;
  }
  if (map.localizer != nullptr) {
    if (forget_motion_.exchange(false)) map.localizer->forget_motion();
    map.localizer->localize(set, estimate_);
  } else if (map.search != nullptr) {
    map.search->search(set, ignored_in_use_, estimate_);
  } else {
    estimate_.reset(PoseReason::no_map, set);
  }
  const Stamp done = monotonic_now();
  utime_offset_ = telemetry_.publish_pose(estimate_, done);
  pacer_.finished(done - begun);
  return true;
}

LocalizationThread::InUse LocalizationThread::with_memory(MapInUse map) {
  InUse use;
  use.news.map = map.identity;
  use.news.alerts.reserve(kMaxAlerts);
  if (map.localizer != nullptr) {
    most_quarantined_ = std::max(most_quarantined_, map.localizer->most_quarantined());
  }
  use.news.quarantine.reserve(most_quarantined_);
  use.listed.reserve(most_quarantined_);
  use.map = std::move(map);
  return use;
}

/// What other threads have asked for since the last turn.
void LocalizationThread::adopt_orders() {
  bool swapped = false;
  {
    const std::lock_guard lock(mutex_);
    swapped = adopt_next_map();
    if (Localizer* const localizer = in_use_.map.localizer.get()) {
      if (swapped || ignored_changed_) localizer->ignore(ignored_);
      for (const MarkerId& marker : to_release_) localizer->release(marker);
    }
    if (ignored_changed_) ignored_in_use_.assign(ignored_.begin(), ignored_.end());
    ignored_changed_ = false;
    to_release_.clear();
  }
  if (swapped) telemetry_.set_map(*in_use_.map.identity);
}

/// The next map, unless the one that the last replaced still waits to be fetched; with the mutex
/// held. False: the map stays.
bool LocalizationThread::adopt_next_map() {
  if (!next_ || replaced_) return false;
  replaced_.swap(next_);
  std::swap(*replaced_, in_use_);
  replaced_->news.replaced = true;
  // Cameras know of no reload: what they gave before it is old after it.
  if (in_use_.map.localizer != nullptr && replaced_->map.localizer != nullptr) {
    in_use_.map.localizer->remember_images_of(*replaced_->map.localizer);
  }
  return true;
}

void LocalizationThread::ignore(std::span<const MarkerId> markers) {
  const std::lock_guard lock(mutex_);
  ignored_.assign(markers.begin(), markers.end());
  ignored_changed_ = true;
}

bool LocalizationThread::release(const MarkerId& marker) {
  const std::lock_guard lock(mutex_);
  if (to_release_.size() == Localizer::kMostOrders) return false;
  to_release_.push_back(marker);
  return true;
}

void LocalizationThread::begin_work() {
  const std::lock_guard lock(mutex_);
  ++counts_.sets;
  counts_.at_work = true;
}

void LocalizationThread::finish_turn(bool took_set, bool localized) {
  Localizer* const localizer = localized ? in_use_.map.localizer.get() : nullptr;
  const bool quarantine_changed = localizer != nullptr && localizer->quarantine_changed();
  if (quarantine_changed) localizer->list_quarantine(in_use_.listed);
  const std::lock_guard lock(mutex_);
  counts_.last_turn = monotonic_now();
  counts_.at_work = false;
  if (took_set && !localized) counts_.passed_over = counts_.last_turn;
  counts_.divisor = pacer_.divisor();
  counts_.skipped = pacer_.skipped();
  if (localized) count_markers();
  if (const MarkerSearch* const search = in_use_.map.search.get(); localized && search != nullptr) {
    counts_.unhealthy = search->unhealthy();
    take_alerts(search->alerts());
  }
  if (localizer == nullptr) return;
  counts_.unhealthy = localizer->unhealthy_cameras();
  count_left_out(*localizer);
  take_alerts(localizer->alerts());
  if (!quarantine_changed) return;
  LocalizationNews& news = in_use_.news;
  news.quarantine.swap(in_use_.listed);
  news.quarantine_changed = true;
}

void LocalizationThread::take_alerts(std::span<const Alert> alerts) {
  std::vector<Alert>& kept = in_use_.news.alerts;
  for (const Alert& alert : alerts) {
    if (kept.size() < kMaxAlerts) {
      kept.push_back(alert);
    } else {
      ++counts_.alerts_lost;
    }
  }
}

/// What the last set showed.
void LocalizationThread::count_markers() {
  tally_.count(estimate_);
  counts_.markers.fill(0);
  for (const ObservedMarker& seen : estimate_.observations) {
    ++counts_.markers[static_cast<std::size_t>(seen.camera)];
  }
}

MarkerTally LocalizationThread::tally() const {
  const std::lock_guard lock(mutex_);
  return tally_;
}

void LocalizationThread::begin_tally() {
  const std::lock_guard lock(mutex_);
  tally_.clear();
}

void LocalizationThread::count_left_out(const Localizer& localizer) {
  for (const DropReason why : {DropReason::unhealthy, DropReason::unsearched}) {
    const CameraMask cameras = localizer.left_out(why);
    for (std::size_t c = 0; c < kMaxCameras; ++c) {
      if ((cameras & camera_bit(c)) != 0) ++counts_.left_out[c][static_cast<std::size_t>(why)];
    }
  }
}

void LocalizationThread::swap_map(MapInUse next) {
  std::optional<InUse> prepared = with_memory(std::move(next));
  const std::lock_guard lock(mutex_);
  next_.swap(prepared);
}

std::vector<LocalizationNews> LocalizationThread::take_news() {
  std::vector<LocalizationNews> taken;
  taken.reserve(2);
  LocalizationNews fresh;
  fresh.alerts.reserve(kMaxAlerts);
  spare_.reserve(most_quarantined_);
  std::optional<InUse> replaced;
  {
    const std::lock_guard lock(mutex_);
    replaced.swap(replaced_);
    LocalizationNews& news = in_use_.news;
    fresh.map = news.map;
    fresh.alerts.swap(news.alerts);
    if (news.quarantine_changed) {
      fresh.quarantine.swap(news.quarantine);
      news.quarantine.swap(spare_);
      fresh.quarantine_changed = std::exchange(news.quarantine_changed, false);
    }
  }
  if (replaced) taken.push_back(std::move(replaced->news));
  taken.push_back(std::move(fresh));
  return taken;
}

LocalizationCounts LocalizationThread::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

}  // namespace waymark
