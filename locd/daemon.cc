#include "locd/daemon.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <future>

#include "core/camera/kalibr.h"
#include "core/map/quarantine.h"
#include "drivers/monotonic_clock.h"
#include "locd/control_socket.h"
#include "locd/localization_thread.h"
#include "locd/realtime.h"
#include "locd/recorder.h"
#include "locd/recording_archive.h"
#include "locd/rig_capture.h"
#include "locd/service_log.h"
#include "locd/service_notifier.h"
#include "locd/status_report.h"

namespace waymark {
namespace {

constexpr Stamp kStatusPeriod = std::chrono::seconds(1);
/// A thread that has not turned for so long is stuck. Localizing one set takes a tenth of it on a
/// slow machine, and cameras turn five times a second.
constexpr Stamp kStuck = std::chrono::seconds(3);

/// What a former run distrusted of the same map.
std::vector<QuarantinedMarker> quarantine_of(const std::string& map_hash,
                                             const std::filesystem::path& file) {
  auto quarantine = read_quarantine(file);
  if (!quarantine || quarantine->map_hash != map_hash) return {};
  return std::move(quarantine->markers);
}

MapInUse map_in_use(const Setup& setup, const std::filesystem::path& quarantine_file) {
  MapInUse map;
  map.time_budget =
      std::chrono::microseconds(std::llround(setup.config.solve.time_budget_ms * 1e3));
  if (!setup.map) return map;
  map.map_hash = setup.map_hash;
  map.world_z_is_up = setup.map->submaps.front().z_is_up;
  map.several_families = setup.map->several_families();
  map.localizer =
      std::make_unique<Localizer>(setup.rig, *setup.map, localizer_options(setup.config));
  map.localizer->restore_quarantine(quarantine_of(map.map_hash, quarantine_file));
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
  Parts(DaemonOptions chosen, Setup read, MapInUse map,
        std::vector<std::unique_ptr<FrameSource>> sources)
      : options(std::move(chosen)),
        setup(std::move(read)),
        several_families(map.several_families),
        quarantine{map.map_hash, quarantine_of(map.map_hash, quarantine_file())},
        telemetry(setup.config.lcm, session_of(setup, map), read_clocks()),
        capture(std::move(sources), sync_options(setup.config), stamp_delays(setup.config)),
        localization(capture, telemetry, std::move(map),
                     [this](const FrameSetLease& set) { recorder.offer(set); }),
        report(setup.rig) {}

  DaemonOptions options;
  Setup setup;
  bool several_families;
  Quarantine quarantine;  ///< as it stands in the state folder
  Telemetry telemetry;
  RigCapture capture;
  Recorder recorder;
  LocalizationThread localization;
  StatusReport report;
  std::optional<ControlSocket> control;
  ServiceNotifier notifier;
  ServiceLog log;
  status_t status{};
  std::vector<RigCapture::CameraState> cameras;
  std::string reload_refused;
  bool was_recording = false;
  std::optional<Error> refusal;
  Stamp started{0};
  Stamp last_status{0};
  bool ready = false;
  std::future<void> ended;  ///< of the threads, once they were told to

  void look_at_cameras(Stamp now);
  void pass_on(const std::vector<Alert>& alerts, Stamp now);
  void publish_status(Stamp now);
  void feed_watchdog(Stamp now);
  void keep_quarantine(Stamp now);
  void look_at_recorder(Stamp now);
  Status start_recording(const std::filesystem::path& folder);
  std::string answer(std::string_view request);
  [[nodiscard]] std::filesystem::path quarantine_file() const {
    return options.state_folder / "quarantine.json";
  }
  Status swap(Setup next);
};

Daemon::Daemon(DaemonOptions options, Setup setup,
               std::vector<std::unique_ptr<FrameSource>> sources) {
  MapInUse map = map_in_use(setup, options.state_folder / "quarantine.json");
  parts_ = std::make_unique<Parts>(std::move(options), std::move(setup), std::move(map),
                                   std::move(sources));
}

Daemon::~Daemon() = default;

Telemetry& Daemon::telemetry() { return parts_->telemetry; }

void Daemon::devices_came() { parts_->capture.retry(); }

const std::optional<Error>& Daemon::refusal() const { return parts_->refusal; }

int Daemon::control_descriptor() const {
  return parts_->control ? parts_->control->descriptor() : -1;
}

Status Daemon::start() {
  Parts& p = *parts_;
  for (const std::string& note : p.setup.notes) p.log.note(note);
  auto control = ControlSocket::open(p.options.runtime_folder / "control");
  if (!control) return tl::make_unexpected(control.error());
  p.control.emplace(std::move(*control));
  if (p.options.record) {
    if (auto recording = p.start_recording(*p.options.record); !recording) return recording;
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
  if (p.telemetry.follow_clocks(read_clocks())) {
    const std::string text = "the machine's clock was set or it slept; utime follows slowly";
    p.telemetry.publish_alert("TIME", "", text, true, now);
    p.log.event("TIME", text, now);
  }
  p.telemetry.keep_alive(now);
  p.look_at_cameras(now);
  p.pass_on(p.localization.take_alerts(), now);
  p.keep_quarantine(now);
  p.look_at_recorder(now);
  p.control->serve([&p](std::string_view request) { return p.answer(request); });
  if (now - p.last_status >= kStatusPeriod) p.publish_status(now);
  p.feed_watchdog(now);
  p.log.summarize(now);
}

void Daemon::Parts::look_at_cameras(Stamp now) {
  cameras.clear();
  for (std::size_t c = 0; c < setup.rig.cameras.size(); ++c) cameras.push_back(capture.state(c));
  report.judge(cameras, now);
  const Stamp grace = std::chrono::seconds(2);
  pass_on(report.camera_alerts(cameras, now, grace), now);
  for (const std::string& line : report.camera_news(cameras)) log.event(line, line, now);
  if (!ready && !refusal) refusal = report.misconfiguration(cameras);
  bool all_run = true;
  for (const auto& camera : cameras) all_run = all_run && camera.running;
  const auto waited = std::chrono::duration<double>(now - started).count();
  if (!ready && !refusal && (all_run || waited >= setup.config.service.startup_wait_s)) {
    ready = true;
    notifier.ready(all_run ? "all cameras stream" : "ready; not all cameras stream");
  }
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
  status.recording = static_cast<std::int8_t>(recording.running);
  status.recording_path = recording.running ? recording.folder.string() : "";
  status.recorded_sets = static_cast<std::int64_t>(recording.sets);
  status.recorded_bytes = static_cast<std::int64_t>(recording.bytes);
  status.recorder_drops = static_cast<std::int64_t>(recording.drops);
  status.map_hash = telemetry.session().map_hash;
  status.text = StatusReport::text(status, cameras);
  telemetry.publish_status(status, now);
  if (ready) notifier.status(status.text);
  if (!telemetry.connected()) {
    log.event("LCM", "LCM takes no messages; is there a route for multicast? Trying on", now);
  }
}

void Daemon::Parts::keep_quarantine(Stamp now) {
  auto markers = localization.take_quarantine();
  if (!markers) return;
  for (QuarantinedMarker& marker : *markers) {
    const auto known = std::find_if(quarantine.markers.begin(), quarantine.markers.end(),
                                    [&](const auto& k) { return k.marker == marker.marker; });
    if (known != quarantine.markers.end()) marker.since_utime = known->since_utime;
    if (marker.since_utime == 0) marker.since_utime = telemetry.utime_us(now);
  }
  quarantine = {telemetry.session().map_hash, std::move(*markers)};
  if (auto written = write_quarantine(quarantine_file(), quarantine); !written) {
    log.event("QUARANTINE", written.error().message, now);
  }
}

void Daemon::Parts::look_at_recorder(Stamp now) {
  const Recorder::State state = recorder.state();
  if (state.running == was_recording) return;
  was_recording = state.running;
  const std::string text = state.running   ? "recording to " + state.folder.string()
                           : state.failure ? "recording ended: " + state.failure->message
                                           : "recording ended: " + state.folder.string();
  const bool wrong = !state.running && state.failure.has_value();
  telemetry.publish_alert("RECORDING", state.folder.string(), text, wrong, now);
  log.event(wrong ? "RECORDING" : text, text, now);
}

Status Daemon::Parts::start_recording(const std::filesystem::path& folder) {
  const Config::Record& record = setup.config.record;
  RecordingFacts facts;
  facts.rig_yaml = format_camchain(setup.rig);
  facts.markers_toml = setup.markers_toml;
  facts.session_id = telemetry.session().session_id;
  facts.version = options.version;
  facts.codec = record.jpeg ? "jpeg" : "pgm";
  facts.sync_tolerance = sync_options(setup.config).tolerance;
  if (folder.parent_path() == record.dir) facts.archive = record.dir;
  RecorderOptions chosen;
  chosen.jpeg = record.jpeg;
  chosen.every_nth = record.every_nth;
  chosen.budget.max_bytes = record.max_bytes;
  chosen.budget.keep =
      std::chrono::duration_cast<Stamp>(std::chrono::duration<double>(record.keep_s));
  chosen.budget.min_free_bytes = record.min_free_bytes;
  chosen.name_offset = telemetry.utime_offset();
  for (const RigCamera& camera : setup.rig.cameras) {
    facts.cameras.push_back(camera.name);
    const CameraParameters& size = camera.model.parameters();
    chosen.pixels.push_back(static_cast<std::size_t>(size.width_px) *
                            static_cast<std::size_t>(size.height_px));
  }
  return recorder.start(folder, facts, chosen);
}

std::string Daemon::Parts::answer(std::string_view request) {
  const auto state = recorder.state();
  if (request == "status") {
    return fmt::format("ok {}", state.running ? "recording to " + state.folder.string()
                                              : std::string("not recording"));
  }
  if (request == "stop") {
    recorder.stop();
    return state.running ? "ok " + state.folder.string() : "ok there was no recording";
  }
  if (request != "start") return "error: the requests are start, stop and status";
  if (state.running) return "error: already recording to " + state.folder.string();
  const auto folder = new_recording_folder(setup.config.record.dir);
  const Status started = folder ? start_recording(*folder) : tl::make_unexpected(folder.error());
  return started ? "ok " + folder->string() : "error: " + started.error().message;
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
  MapInUse map = map_in_use(next, quarantine_file());
  several_families = map.several_families;
  quarantine = {map.map_hash, quarantine_of(map.map_hash, quarantine_file())};
  setup = std::move(next);
  localization.swap_map(std::move(map));
  return {};
}

bool Daemon::stop(Stamp patience) {
  Parts& p = *parts_;
  if (!p.ended.valid()) {
    p.notifier.stopping();
    // In a thread of its own: a driver's call that never returns must not hold up the end.
    std::promise<void> ended;
    p.ended = ended.get_future();
    std::thread([&p, ended = std::move(ended)]() mutable {
      p.capture.stop();
      p.localization.stop();
      p.recorder.stop();
      ended.set_value_at_thread_exit();
    }).detach();
  }
  return p.ended.wait_for(patience) == std::future_status::ready;
}

}  // namespace waymark
