#include "locd/service/daemon.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <future>
#include <thread>

#include "core/base/notes.h"
#include "core/map/quarantine.h"
#include "drivers/monotonic_clock.h"
#include "locd/frames/realtime.h"
#include "locd/frames/rig_capture.h"
#include "locd/publish/link_watch.h"
#include "locd/publish/status_report.h"
#include "locd/record/quarantine_file.h"
#include "locd/record/recorder.h"
#include "locd/service/control_socket.h"
#include "locd/service/localization_thread.h"
#include "locd/service/recording_control.h"
#include "locd/service/service_log.h"
#include "locd/service/service_notifier.h"

namespace waymark {
namespace {

constexpr Stamp kStatusPeriod = std::chrono::seconds(1);
/// A thread that has not turned for so long is stuck. Localizing one set takes a tenth of it on a
/// slow machine, and cameras turn five times a second.
constexpr Stamp kStuck = std::chrono::seconds(3);
/// A camera's first start takes less, or is held up: what is wrong with it is then not known yet.
constexpr Stamp kFirstStart = std::chrono::seconds(2);

MapInUse map_in_use(const Setup& setup, QuarantineFile& quarantine) {
  MapInUse map;
  map.time_budget =
      std::chrono::microseconds(std::llround(setup.config.solve.time_budget_ms * 1e3));
  if (!setup.map) return map;
  map.map_hash = setup.map_hash;
  map.world_z_is_up = setup.map->submaps.front().z_is_up;
  map.several_families = setup.map->several_families();
  map.localizer =
      std::make_unique<Localizer>(setup.rig, *setup.map, localizer_options(setup.config));
  map.localizer->restore_quarantine(quarantine.of_map(map.map_hash));
  return map;
}

SessionFacts session_of(const Setup& setup, const MapInUse& map) {
  return {new_session_id(), map.map_hash, setup.config.rig.base_from_rig, map.world_z_is_up,
          setup.rig.cameras.size()};
}

std::size_t marker_count(const Setup& setup) {
  return setup.map ? setup.map->submaps.front().markers.size() : 0;
}

std::filesystem::path folder_from(const char* variable, const char* fallback) {
  // systemd lists several folders with colons between; ours is the first.
  const char* const named = std::getenv(variable);
  const std::string folders = named != nullptr ? named : "";
  return folders.empty() ? std::string(fallback) : folders.substr(0, folders.find(':'));
}

}  // namespace

DaemonOptions options_from_environment() {
  DaemonOptions options;
  options.runtime_folder = folder_from("RUNTIME_DIRECTORY", "/run/locd");
  options.state_folder = folder_from("STATE_DIRECTORY", "/var/lib/locd");
  return options;
}

struct Daemon::Parts {
  Parts(DaemonOptions chosen, Setup read, std::unique_ptr<QuarantineFile> file, MapInUse map,
        std::vector<std::unique_ptr<FrameSource>> sources)
      : options(std::move(chosen)),
        setup(std::move(read)),
        several_families(map.several_families),
        quarantine_file(std::move(file)),
        quarantine{map.map_hash, quarantine_file->of_map(map.map_hash)},
        telemetry(setup.config.lcm, session_of(setup, map), options.read_clocks(), setup.key),
        capture(std::move(sources), sync_options(setup.config), stamp_delays(setup.config)),
        localization(capture, telemetry, std::move(map),
                     [this](const FrameSetLease& set, Stamp utime_offset) {
                       recorder.offer(set, utime_offset);
                     }),
        report(setup.rig) {}

  DaemonOptions options;
  Setup setup;
  bool several_families;
  std::unique_ptr<QuarantineFile> quarantine_file;
  Quarantine quarantine;  ///< as it stands in the state folder, or soon will
  Telemetry telemetry;
  RigCapture capture;
  Recorder recorder;
  RecordingControl recordings{recorder, [this] {
                                return plan_recording(setup, telemetry,
                                                      options.state_folder / "recordings",
                                                      options.version);
                              }};
  LocalizationThread localization;
  StatusReport report;
  LinkWatch link;
  std::optional<ControlSocket> control;
  ServiceNotifier notifier;
  ServiceLog log;
  status_t status{};
  std::vector<RigCapture::CameraState> cameras;
  std::string reload_refused;
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
  void pass_on(const std::vector<Alert>& alerts, Stamp now);
  void publish_status(Stamp now);
  void look_at_link(Stamp now);
  void feed_watchdog(Stamp now);
  void keep_quarantine(Stamp now);
  void look_at_recorder(Stamp now);
  Status swap(Setup next);
};

Daemon::Daemon(DaemonOptions options, Setup setup,
               std::vector<std::unique_ptr<FrameSource>> sources) {
  auto quarantine = std::make_unique<QuarantineFile>(options.state_folder / "quarantine.json");
  MapInUse map = map_in_use(setup, *quarantine);
  parts_ = std::make_unique<Parts>(std::move(options), std::move(setup), std::move(quarantine),
                                   std::move(map), std::move(sources));
}

Daemon::~Daemon() = default;

Telemetry& Daemon::telemetry() { return parts_->telemetry; }

void Daemon::devices_came() {
  parts_->log.event("DEVICE", "a video device was plugged in: missing cameras are tried at once",
                    monotonic_now());
  parts_->capture.retry();
}

const std::optional<Error>& Daemon::refusal() const { return parts_->refusal; }

int Daemon::control_descriptor() const {
  return parts_->control ? parts_->control->descriptor() : -1;
}

Status Daemon::start() {
  Parts& p = *parts_;
  for (const std::string& note : shown_notes(p.setup.notes)) p.log.note(note);
  auto control = ControlSocket::open(p.options.runtime_folder / "control");
  if (!control) return tl::make_unexpected(control.error());
  p.control.emplace(std::move(*control));
  if (p.options.record) {
    if (auto recording = p.recordings.record_from_the_start(*p.options.record); !recording)
      return recording;
  }
  p.started = p.last_status = monotonic_now();
  const Config::Service& service = p.setup.config.service;
  if (service.realtime) {
    if (auto permitted = check_realtime(); !permitted) return permitted;
  }
  if (service.lock_memory) {
    if (auto locked = lock_memory(); !locked) return locked;
  }
  p.capture.start(service.realtime);
  p.localization.start(service.realtime);
  p.log.note(fmt::format("session {}: {} cameras, {} markers{}", p.telemetry.session().session_id,
                         p.setup.rig.cameras.size(), marker_count(p.setup),
                         p.setup.map_hash.empty() ? "" : ", map " + p.setup.map_hash));
  return {};
}

void Daemon::turn(Stamp now) {
  Parts& p = *parts_;
  if (p.telemetry.follow_clocks(p.options.read_clocks())) {
    const std::string text = "the machine's clock was set or it slept; utime follows slowly";
    p.telemetry.publish_alert("TIME", "", text, true, now);
    p.log.event("TIME", text, now);
  }
  p.telemetry.keep_alive(now, p.why_without_pose(now));
  p.look_at_cameras(now);
  p.pass_on(p.localization.take_alerts(), now);
  p.keep_quarantine(now);
  p.look_at_recorder(now);
  p.control->serve(
      [&p, now](std::string_view request) { return p.recordings.handle(request, now); }, now);
  if (now - p.last_status >= kStatusPeriod) p.publish_status(now);
  p.feed_watchdog(now);
  p.log.summarize(now);
}

PoseReason Daemon::Parts::why_without_pose(Stamp now) const {
  const LocalizationCounts counts = localization.counts();
  const bool frames_come = counts.at_work || now - counts.passed_over < Telemetry::kHeartbeat;
  return frames_come ? PoseReason::overload : PoseReason::no_frames;
}

void Daemon::Parts::look_at_cameras(Stamp now) {
  cameras.clear();
  for (std::size_t c = 0; c < setup.rig.cameras.size(); ++c) cameras.push_back(capture.state(c));
  report.judge(cameras, now);
  const Stamp grace = std::chrono::seconds(2);
  pass_on(report.camera_alerts(cameras, now, grace), now);
  for (const std::string& line : report.camera_news(cameras)) log.event(line, line, now);
  if (!ready && !refusal) refusal = report.misconfiguration(cameras);
  const bool all_run = report.all_run();
  if (!ready && !refusal && (all_run || has_waited_enough(now))) {
    ready = true;
    notifier.ready(all_run ? "all cameras stream" : "ready; not all cameras stream");
  }
}

bool Daemon::Parts::has_waited_enough(Stamp now) const {
  const bool all_tried = std::all_of(cameras.begin(), cameras.end(),
                                     [](const auto& camera) { return camera.starts > 0; });
  const auto waited_s = std::chrono::duration<double>(now - started).count();
  return waited_s >= setup.config.service.startup_wait_s &&
         (all_tried || now - started >= kFirstStart);
}

void Daemon::Parts::pass_on(const std::vector<Alert>& alerts, Stamp now) {
  for (const Alert& alert : alerts) {
    telemetry.publish_alert(alert, setup.rig, several_families, now);
    const std::string text = describe(alert, setup.rig, several_families);
    log.event(text, text, now);
  }
}

void Daemon::Parts::publish_status(Stamp now) {
  report.fill(cameras, localization.counts(), now - last_status, status);
  last_status = now;
  status.version = options.version;
  status.map_markers = static_cast<std::int32_t>(marker_count(setup));
  status.reload_refused = reload_refused;
  status.quarantined_markers = static_cast<std::int32_t>(quarantine.markers.size());
  const Recorder::State recording = recorder.state();
  status.recording = static_cast<std::int8_t>(recording.running());
  status.recording_path = recording.running() ? recording.folder.string() : "";
  status.recorded_sets = static_cast<std::int64_t>(recording.sets);
  status.recorded_bytes = static_cast<std::int64_t>(recording.bytes);
  status.recorder_drops = static_cast<std::int64_t>(recording.drops);
  status.map_hash = telemetry.session().map_hash;
  status.text = StatusReport::text(status);
  if (const auto trouble = quarantine_file->trouble(); !trouble.empty()) {
    status.text += "; " + trouble;
  }
  telemetry.publish_status(status, now);
  look_at_link(now);
  // Whoever asks systemd can't hear that nothing is heard.
  if (ready) notifier.status(status.text + (link.down() ? ", LCM takes no messages" : ""));
}

void Daemon::Parts::look_at_link(Stamp now) {
  const LcmPublisher& publisher = telemetry.publisher();
  const auto news = link.look(publisher.failures());
  if (!news) return;
  const std::string text =
      news->raised ? "LINK: messages are not taken: " +
                         describe(publisher.last_failure(), publisher.address())
                   : fmt::format("LINK is over: messages are taken again; {} were not", news->lost);
  telemetry.publish_alert("LINK", publisher.address().text(), text, news->raised, now);
  log.event(news->raised ? "LINK" : "LINK is over", text, now);
}

void Daemon::Parts::keep_quarantine(Stamp now) {
  for (const QuarantineFile::News& news : quarantine_file->take_news()) {
    telemetry.publish_alert("QUARANTINE", "", news.text, news.wrong, now);
    log.event(news.text, news.text, now);
  }
  auto markers = localization.take_quarantine();
  if (!markers) return;
  for (QuarantinedMarker& marker : *markers) {
    const auto known = std::find_if(quarantine.markers.begin(), quarantine.markers.end(),
                                    [&](const auto& k) { return k.marker == marker.marker; });
    if (known != quarantine.markers.end()) marker.since_utime = known->since_utime;
    if (marker.since_utime == 0) marker.since_utime = telemetry.utime_us(now);
  }
  quarantine = {telemetry.session().map_hash, std::move(*markers)};
  quarantine_file->write(quarantine);
}

void Daemon::Parts::look_at_recorder(Stamp now) {
  recorder.set_date_known(telemetry.date_known());
  for (const RecordingNews& news : recordings.take_news()) {
    telemetry.publish_alert("RECORDING", news.folder, news.text, news.wrong, now);
    log.event(news.wrong ? "RECORDING" : news.text, news.text, now);
  }
}

void Daemon::Parts::feed_watchdog(Stamp now) {
  bool all_turn = now - localization.counts().last_turn < kStuck || now - started < kStuck;
  for (const auto& camera : cameras) {
    all_turn = all_turn && (now - camera.last_turn < kStuck || now - started < kStuck);
  }
  if (all_turn) {
    notifier.feed_watchdog(now);
    if (!ready) notifier.extend_start(now);
  } else {
    log.event("STUCK", "a thread does not turn; the watchdog is not fed", now);
  }
}

void Daemon::reload() {
  Parts& p = *parts_;
  const Stamp now = monotonic_now();
  // Before ready only the start itself ends in READY=1, which would have to end a reload as well.
  if (p.ready) p.notifier.reloading(now);
  auto next = load_setup(p.options.config);
  const Status swapped = next ? p.swap(std::move(*next)) : tl::make_unexpected(next.error());
  p.reload_refused = swapped ? "" : swapped.error().message;
  const std::string text = swapped ? "reloaded: " + p.options.config.string()
                                   : "reload refused, all stays as it was: " + p.reload_refused;
  p.telemetry.publish_alert("RELOAD", p.options.config.string(), text, !swapped, now);
  p.log.note(text);
  p.ready ? p.notifier.ready(text) : p.notifier.status(text);
}

Status Daemon::Parts::swap(Setup next) {
  if (const auto key = key_that_needs_restart(setup.config, next.config)) {
    return fail(ErrorKind::config, "{}: {} has changed, which needs a restart",
                options.config.string(), *key);
  }
  if (!same_rig(setup.rig, next.rig)) {
    return fail(ErrorKind::config, "{}: the rig has changed, which needs a restart",
                next.config.rig.camchain.string());
  }
  if (setup.key != next.key) {
    return fail(ErrorKind::config, "{}: the key has changed, which needs a restart",
                next.config.lcm.key_file.string());
  }
  MapInUse map = map_in_use(next, *quarantine_file);
  several_families = map.several_families;
  quarantine = {map.map_hash, quarantine_file->of_map(map.map_hash)};
  setup = std::move(next);
  localization.swap_map(std::move(map));
  recorder.set_budget(recording_budget(setup.config.record));
  return {};
}

Status Daemon::stop(Stamp patience) {
  Parts& p = *parts_;
  const Stamp deadline = monotonic_now() + patience;
  if (!p.ended.valid()) {
    p.notifier.stopping();
    // At once: what was recorded has all of the time to reach the disk.
    p.recorder.stop();
    // In a thread of its own: a driver's call that never returns must not hold up the end.
    std::promise<void> ended;
    p.ended = ended.get_future();
    p.ender = std::thread([&p, ended = std::move(ended)]() mutable {
      p.ending = "localization";
      p.localization.stop();
      p.ending = "a camera's driver";
      p.capture.stop();
      ended.set_value();
    });
  }
  const auto left = [&] { return deadline - monotonic_now(); };
  if (p.ended.wait_for(left()) != std::future_status::ready) {
    if (p.recorder.settle(deadline)) {
      return fail(ErrorKind::unavailable, "{} does not return; ending without", p.ending.load());
    }
    return fail(ErrorKind::unavailable,
                "neither {} nor the disk with the recording returns; ending without",
                p.ending.load());
  }
  if (p.ender.joinable()) p.ender.join();
  if (!p.recorder.settle(deadline)) {
    return fail(ErrorKind::unavailable, "the disk does not take the recording; ending without");
  }
  if (!p.quarantine_file->settle(deadline)) {
    return fail(ErrorKind::unavailable, "the disk does not take quarantine.json; ending without");
  }
  return {};
}

}  // namespace waymark
