#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "core/base/priority_mutex.h"
#include "locd/frames/rig_capture.h"
#include "locd/frames/set_pacer.h"
#include "locd/pose/localizer.h"
#include "locd/pose/marker_search.h"
#include "locd/publish/localization_counts.h"
#include "locd/publish/telemetry.h"
#include "locd/record/marker_tally.h"

namespace waymark {

/// A localizer with its map's identity, swapped as one between two sets.
struct MapInUse {
  std::shared_ptr<const MapIdentity> identity = std::make_shared<const MapIdentity>();
  std::unique_ptr<Localizer> localizer;  ///< null: recording only
  std::unique_ptr<MarkerSearch>
      search;            ///< where there is no localizer; null: images are not looked at
  Stamp time_budget{0};  ///< a set older than this is dropped
};

/// The results of localization besides poses, all of them found with one map.
struct LocalizationNews {
  std::shared_ptr<const MapIdentity> map;
  std::vector<Alert> alerts;
  bool quarantine_changed = false;
  std::vector<QuarantinedMarker> quarantine;  ///< where it has changed
  bool replaced = false;  ///< another map is in use: these are the last news of this one
};

/// The thread that turns frame sets into published poses. It waits for nothing but frames: alerts,
/// quarantine and counts are kept for take_news and counts, which other threads call.
class LocalizationThread {
 public:
  /// Takes sets of `capture`; hands each to `after_set` when its pose is out (the recorder), with
  /// what made the pose's utime of its stamp.
  LocalizationThread(RigCapture& capture, Telemetry& telemetry, MapInUse map,
                     std::function<void(const FrameSetLease&, Stamp utime_offset)> after_set);
  ~LocalizationThread();
  LocalizationThread(const LocalizationThread&) = delete;
  LocalizationThread& operator=(const LocalizationThread&) = delete;

  /// `realtime`: on SCHED_FIFO, where the system permits it.
  void start(bool realtime = false);
  /// Ends the thread after the set that it is localizing.
  void stop();

  /// `next` takes over with the next set. What it replaces is destroyed in a later call of
  /// take_news, on the caller's thread. One thread calls both.
  void swap_map(MapInUse next);

  /// Leaves these markers (at most Localizer::kMostOrders, by rising id) out of everything from the
  /// next set on, in this map and the next ones.
  void ignore(std::span<const MarkerId> markers);
  /// Ends the marker's quarantine with the next set. False: too many are to be released by then.
  [[nodiscard]] bool release(const MarkerId& marker);

  /// What has come since the last call, of the map that was replaced first. More than kMaxAlerts
  /// alerts between two calls are counted as lost.
  [[nodiscard]] std::vector<LocalizationNews> take_news();
  static constexpr std::size_t kMaxAlerts = 128;

  /// Prior and velocity are discarded before the next set.
  void forget_motion() { forget_motion_ = true; }

  [[nodiscard]] LocalizationCounts counts() const;
  /// The markers that were seen since the last call of begin_tally.
  [[nodiscard]] MarkerTally tally() const;
  void begin_tally();

 private:
  void run();
  /// False when the set came too late.
  bool localize(const FrameSetLease& set);
  void adopt_orders();
  [[nodiscard]] bool adopt_next_map();
  void begin_work();
  void finish_turn(bool took_set, bool localized);
  void count_left_out(const Localizer& localizer);
  void count_markers();
  void take_alerts(std::span<const Alert> alerts);

  /// The map in use, its news, and the memory that a quarantine is listed in, all that it takes.
  struct InUse {
    MapInUse map;
    LocalizationNews news;
    std::vector<QuarantinedMarker> listed;
  };
  [[nodiscard]] InUse with_memory(MapInUse map);

  RigCapture& capture_;
  Telemetry& telemetry_;
  std::function<void(const FrameSetLease&, Stamp utime_offset)> after_set_;
  PoseEstimate estimate_;
  std::optional<Stamp> utime_offset_;  ///< of the set's pose; nullopt: it has none
  SetPacer pacer_;
  std::vector<MarkerId> ignored_in_use_;  ///< where there is no localizer
  std::atomic<bool> stopping_{false};
  std::atomic<bool> forget_motion_{false};
  /// Of the thread that calls take_news: memory that is swapped for what is taken, and how much of
  /// it any map needs.
  std::vector<QuarantinedMarker> spare_;
  std::size_t most_quarantined_ = 0;
  mutable PriorityMutex mutex_;  ///< of news and everything below; held for copies and swaps only
  InUse in_use_;
  std::optional<InUse> next_;
  std::optional<InUse> replaced_;
  std::vector<MarkerId> ignored_;
  bool ignored_changed_ = false;
  MarkerTally tally_;
  std::vector<MarkerId> to_release_;
  LocalizationCounts counts_;
  std::thread thread_;
};

}  // namespace waymark
