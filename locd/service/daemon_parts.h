#pragma once

#include <atomic>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "locd/frames/rig_capture.h"
#include "locd/publish/link_watch.h"
#include "locd/publish/status_report.h"
#include "locd/record/quarantine_file.h"
#include "locd/record/recorder.h"
#include "locd/service/control_socket.h"
#include "locd/service/daemon.h"
#include "locd/service/localization_thread.h"
#include "locd/service/operator_requests.h"
#include "locd/service/recording_control.h"
#include "locd/service/reload_thread.h"
#include "locd/service/service_log.h"
#include "locd/service/service_notifier.h"
#include "locd/service/unused_markers.h"

namespace waymark {

/// What a daemon consists of, for the sources that make it up.
struct Daemon::Parts {
  Parts(DaemonOptions chosen, Setup read, std::unique_ptr<QuarantineFile> file, MapInUse map_in_use,
        std::vector<std::unique_ptr<FrameSource>> sources);

  DaemonOptions options;
  Setup setup;
  /// The one that the setup names; the localization adopts it a little later.
  std::shared_ptr<const MapIdentity> map;
  std::unique_ptr<QuarantineFile> quarantine_file;
  UnusedMarkers unused;
  Telemetry telemetry;
  RigCapture capture;
  Recorder recorder;
  RecordingControl recordings{recorder,
                              [this] {
                                return plan_recording(setup, telemetry,
                                                      options.state_folder / "recordings",
                                                      options.version);
                              },
                              [this] { return localization.tally().verdict(); }};
  LocalizationThread localization;
  StatusReport report;
  LinkWatch link;
  std::optional<ControlSocket> control;
  OperatorRequests requests;
  ServiceNotifier notifier;
  ServiceLog log;
  std::vector<Alert> standing;  ///< alerts of the localization that were raised and are not over
  status_t status{};
  std::vector<RigCapture::CameraState> cameras;
  Status last_reload;               ///< why it was refused
  std::uint64_t reloads_ended = 0;  ///< since the start
  std::optional<Error> refusal;
  Stamp started{0};
  Stamp last_status{0};
  bool ready = false;
  std::atomic<const char*> ending{""};  ///< what is just told to end
  std::future<void> ended;              ///< of the threads, once they were told to
  std::thread ender;                    ///< what tells them; joined once `ended` is there

  [[nodiscard]] PoseReason why_without_pose(Stamp now) const;
  [[nodiscard]] bool has_waited_enough(Stamp now) const;
  void look_at_cameras(Stamp now);
  void publish_and_log(const Alert& alert, const MapIdentity& found_with, Stamp now);
  void pass_on(const LocalizationNews& news, Stamp now);
  void end_alerts_of_replaced(const MapIdentity& replaced, Stamp now);
  /// What is so at this moment, whenever the last report was made.
  void tell_present(status_t& told) const;
  void publish_status(Stamp now);
  void look_at_link(Stamp now);
  void feed_watchdog(Stamp now);
  void look_at_quarantine_file(Stamp now);
  void look_at_recorder(Stamp now);
  [[nodiscard]] Status check_reload(const Setup& next) const;
  [[nodiscard]] Expected<Replacement> prepare_reload() const;
  void swap(Replacement next);
  void finish_reload(Expected<Replacement> next, Stamp now);
  void begin_reload();

  // daemon_requests.cc: what operators may ask for.
  void take_requests();
  [[nodiscard]] ControlAnswer describe_status() const;
  [[nodiscard]] ControlAnswer describe_calibration() const;
  [[nodiscard]] PendingReply reload_on_request(Stamp now);
  [[nodiscard]] Expected<MarkerId> marker_named(std::string_view text) const;
  [[nodiscard]] ControlReply release(std::string_view text);
  [[nodiscard]] ControlReply ignore(std::string_view text, Stamp now);
  [[nodiscard]] ControlReply allow(std::string_view text);

  ReloadThread reloads{[this] { return prepare_reload(); }};  ///< ends first, for it uses the rest
};

}  // namespace waymark
