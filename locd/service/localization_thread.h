#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/base/priority_mutex.h"
#include "locd/frames/rig_capture.h"
#include "locd/frames/set_pacer.h"
#include "locd/pose/localizer.h"
#include "locd/publish/localization_counts.h"
#include "locd/publish/telemetry.h"

namespace waymark {

/// A localizer with the name of its map, swapped as one between two sets.
struct MapInUse {
  std::string map_hash;
  bool world_z_is_up = false;
  bool several_families = false;
  std::unique_ptr<Localizer> localizer;  ///< null: recording only
  Stamp time_budget{0};                  ///< a set older than this is dropped
};

/// The thread that turns frame sets into published poses. It waits for nothing but frames: what it
/// has to tell besides poses is left for others to fetch.
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
  /// Ends after the set it is at.
  void stop();

  /// `next` takes over with the next set. What it replaces is destroyed in a later call of
  /// swap_map or alerts, on the caller's thread.
  void swap_map(MapInUse next);

  /// Alerts since the last call. More than kMaxAlerts between two calls are counted as lost.
  [[nodiscard]] std::vector<Alert> take_alerts();
  static constexpr std::size_t kMaxAlerts = 128;

  /// Markers in quarantine, when that has changed since the last call.
  [[nodiscard]] std::optional<std::vector<QuarantinedMarker>> take_quarantine();

  /// Prior and velocity are discarded before the next set.
  void forget_motion() { forget_motion_ = true; }

  [[nodiscard]] LocalizationCounts counts() const;

 private:
  void run();
  /// False when the set came too late.
  bool localize(const FrameSetLease& set);
  void lose(const FrameSetLease& set, PoseReason why);
  void adopt_next_map();
  void begin_work();
  void leave_word(bool took_set, bool localized);

  RigCapture& capture_;
  Telemetry& telemetry_;
  std::function<void(const FrameSetLease&, Stamp utime_offset)> after_set_;
  MapInUse map_;
  PoseEstimate estimate_;
  std::optional<Stamp> utime_offset_;  ///< of the set's pose; nullopt: it has none
  SetPacer pacer_;
  std::atomic<bool> stopping_{false};
  std::atomic<bool> forget_motion_{false};
  mutable PriorityMutex mutex_;  ///< of everything below; held for copies only
  std::optional<MapInUse> next_map_;
  std::optional<MapInUse> replaced_map_;
  std::vector<Alert> alerts_;
  std::optional<std::vector<QuarantinedMarker>> quarantine_;
  LocalizationCounts counts_;
  std::thread thread_;
};

}  // namespace waymark
