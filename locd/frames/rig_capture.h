#pragma once

#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "core/base/priority_mutex.h"
#include "drivers/frame_source.h"
#include "locd/frames/back_off.h"
#include "locd/frames/frame_synchronizer.h"
#include "locd/frames/stamp_guard.h"

namespace waymark {

/// All cameras of a rig, each in a thread of its own, and the newest frame set they gave. A camera
/// that fails is started again after a pause that grows to 5 s, or at once when a video device is
/// plugged in.
class RigCapture {
 public:
  /// One source per camera, by the rig's order; `stamp_delays` likewise, or none.
  RigCapture(std::vector<std::unique_ptr<FrameSource>> sources, const SyncOptions& options,
             const std::vector<Stamp>& stamp_delays = {});
  ~RigCapture();
  RigCapture(const RigCapture&) = delete;
  RigCapture& operator=(const RigCapture&) = delete;

  /// Starts the threads; `realtime`: on SCHED_FIFO, where the system permits it.
  void start(bool realtime = false);
  /// Ends them; within a second where the drivers' calls return.
  void stop();

  /// A device has come: cameras that pause are started again at once.
  void retry();

  /// The newest set that was not taken yet; nullopt when none came until `deadline`
  /// (CLOCK_MONOTONIC), after stop, or when all sources have ended.
  [[nodiscard]] std::optional<FrameSetLease> wait(Stamp deadline);

  /// Whether every source has ended and every set was taken.
  [[nodiscard]] bool ended() const;

  /// What a status message says of a camera.
  struct CameraState {
    Stamp last_frame{0};  ///< arrival
    /// When its loop, or one of the device's calls within it, last turned: the watchdog is fed only
    /// while it advances.
    Stamp last_turn{0};
    std::uint64_t frames = 0;
    std::uint64_t damaged = 0;
    std::uint64_t lost = 0;  ///< frames that the device took but did not deliver
    std::uint64_t starts = 0;
    bool unsynced = false;  ///< its stamps can't be believed; arrival times are used
    DropCounts dropped{};
    std::string description;       ///< what runs since its last start, once it gave a frame
    std::string changed_settings;  ///< by another program, until mended; empty: none
    std::string error;             ///< of what failed last, until a frame comes; empty: none
    bool misconfigured = false;    ///< it failed last for what only another configuration mends
  };
  [[nodiscard]] CameraState state(std::size_t camera) const;
  [[nodiscard]] CameraMask quorum() const;

 private:
  struct Camera {
    std::unique_ptr<FrameSource> source;
    CameraState state;
    StampGuard stamps;
    bool ended = false;
    std::thread thread;
  };
  void run(std::size_t camera, bool realtime);
  void deliver(std::size_t camera, Frame frame);
  /// With the mutex held: makes sets that are ready the newest one.
  void gather(Stamp now);
  /// False when it shall stop.
  bool pause(Camera& camera, BackOff& back_off, std::uint64_t retries_seen);

  mutable PriorityMutex mutex_;
  PriorityCondition changed_;
  std::vector<Camera> cameras_;
  FrameSynchronizer synchronizer_;
  std::optional<FrameSetLease> newest_;
  bool stopping_ = false;
  std::uint64_t retries_ = 0;  ///< calls of retry()
};

}  // namespace waymark
