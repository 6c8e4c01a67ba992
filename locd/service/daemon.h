#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/base/error.h"
#include "drivers/frame_source.h"
#include "locd/publish/telemetry.h"
#include "locd/service/setup.h"

namespace waymark {

/// `locd --config`.
struct DaemonOptions {
  std::filesystem::path config;
  std::optional<std::filesystem::path> record;  ///< --record: recorded from the start, here
  std::string version;
  /// Where the control socket and the lock are: RUNTIME_DIRECTORY as systemd sets it, or /run/locd.
  std::filesystem::path runtime_folder;
  /// Where the quarantine is: STATE_DIRECTORY, or /var/lib/locd.
  std::filesystem::path state_folder;
  /// The machine's clocks, asked by the service thread only; a test's are under its hand.
  std::function<ClockReading()> read_clocks = waymark::read_clocks;
  /// How a reload reads what the configuration names, in a thread of its own; a test's may take
  /// long.
  std::function<Expected<Setup>(const std::filesystem::path&)> load_setup = waymark::load_setup;
};

/// The options' folders from the environment.
[[nodiscard]] DaemonOptions options_from_environment();

/// locd: cameras → frame set → detections → pose → LCM. Camera threads and the localization thread
/// do that; the thread that calls turn() does everything else: heartbeat, status, alerts, requests,
/// reloads, the watchdog.
class Daemon {
 public:
  /// A source per camera of the setup's rig. Starts nothing yet.
  Daemon(DaemonOptions options, Setup setup, std::vector<std::unique_ptr<FrameSource>> sources);
  ~Daemon();
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  /// Opens the control socket, restores the quarantine, starts the threads.
  [[nodiscard]] Status start();
  /// What is due at `now` besides poses; call it every 100 ms, and when a pose is due
  /// (telemetry().next_keep_alive()).
  void turn(Stamp now);
  /// Has the configuration read again, in a thread of its own. A later turn swaps map, tunables and
  /// recording budget, or says why it is refused whole. Of several requests the newest wins.
  void reload();
  /// Ends the threads, with all that was recorded on the disk. unavailable, naming what does not
  /// return (a camera's driver, the disk, a reload), when that takes longer than `patience`: until
  /// a later call succeeds the object must not be destroyed, but the process may end without.
  [[nodiscard]] Status stop(Stamp patience);

  /// Video devices have come: cameras that are absent are tried at once.
  void devices_came();
  /// Before the service is ready: why no start can go well with this configuration. A camera that
  /// is only absent is no reason.
  [[nodiscard]] const std::optional<Error>& refusal() const;

  /// What a waiting service loop may watch for requests; −1 before start.
  [[nodiscard]] int control_descriptor() const;
  [[nodiscard]] Telemetry& telemetry();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace waymark
