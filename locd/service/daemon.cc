#include "locd/service/daemon.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <span>
#include <utility>

#include "core/camera/rig_fingerprint.h"
#include "core/map/quarantine.h"
#include "core/marker/marker_catalog.h"
#include "drivers/monotonic_clock.h"
#include "locd/frames/realtime.h"
#include "locd/service/daemon_parts.h"

namespace waymark {
namespace {

constexpr Stamp kStatusPeriod = std::chrono::seconds(1);
/// A thread that has not turned for so long is stuck. Localizing one set takes a tenth of it on a
/// slow machine, and cameras turn five times a second.
constexpr Stamp kStuck = std::chrono::seconds(3);
/// A camera's first start takes less, or is held up: what is wrong with it is then not known yet.
constexpr Stamp kFirstStart = std::chrono::seconds(2);

/// `quarantined`: what is known of the setup's map already.
MapInUse map_in_use(const Setup& setup, std::span<const QuarantinedMarker> quarantined) {
  MapInUse map;
  map.time_budget =
      std::chrono::microseconds(std::llround(setup.config.solve.time_budget_ms * 1e3));
  if (!setup.map) {
    // What stands there was written from a catalog: an empty one where nobody states any markers.
    const auto catalog = parse_marker_catalog(setup.markers_toml, "markers.toml");
    map.search = std::make_unique<MarkerSearch>(setup.rig, catalog ? *catalog : MarkerCatalog(),
                                                localizer_options(setup));
    return map;
  }
  map.identity = std::make_shared<const MapIdentity>(MapIdentity{
      setup.map_hash, setup.map->submaps.front().z_is_up, setup.map->several_families()});
  map.localizer = std::make_unique<Localizer>(setup.rig, *setup.map, localizer_options(setup));
  map.localizer->restore_quarantine(quarantined);
  return map;
}

SessionFacts session_of(const Setup& setup, const MapInUse& map) {
  return {new_session_id(),
          map.identity->map_hash,
          setup.config.rig.base_from_rig,
          map.identity->world_z_is_up,
          setup.rig.cameras.size(),
          fingerprint(setup.rig)};
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

Daemon::Parts::Parts(DaemonOptions chosen, Setup read, std::unique_ptr<QuarantineFile> file,
                     MapInUse map_in_use, std::vector<std::unique_ptr<FrameSource>> sources)
    : options(std::move(chosen)),
      setup(std::move(read)),
      map(map_in_use.identity),
      quarantine_file(std::move(file)),
      unused(*quarantine_file, map->map_hash),
      telemetry(setup.config.lcm, session_of(setup, map_in_use), options.read_clocks(), setup.key),
      capture(std::move(sources), sync_options(setup.config), stamp_delays(setup.config)),
      localization(capture, telemetry, std::move(map_in_use),
                   [this](const FrameSetLease& set, Stamp utime_offset) {
                     recorder.offer(set, utime_offset);
                   }),
      report(setup.rig) {
  localization.ignore(unused.ignored());
  take_requests();
}

Daemon::Daemon(DaemonOptions options, Setup setup,
               std::vector<std::unique_ptr<FrameSource>> sources) {
  auto quarantine = std::make_unique<QuarantineFile>(options.state_folder / "quarantine.json");
  MapInUse map = map_in_use(setup, quarantine->of_map(setup.map_hash));
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
  for (const std::string& line : told_of(p.setup)) p.log.note(line);
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
  const ClockEvent event = p.telemetry.follow_clocks(p.options.read_clocks());
  // Where the vehicle was before says nothing of where it is.
  if (event == ClockEvent::slept) p.localization.forget_motion();
  if (event != ClockEvent::none) {
    const std::string text = "the machine's clock was set or it slept; utime follows slowly";
    p.telemetry.publish_alert("TIME", "", text, true, now);
    p.log.event("TIME", text, now);
  }
  p.telemetry.keep_alive(now, p.why_without_pose(now));
  p.look_at_cameras(now);
  for (const LocalizationNews& news : p.localization.take_news()) p.pass_on(news, now);
  p.look_at_quarantine_file(now);
  if (auto next = p.reloads.take()) p.finish_reload(std::move(*next), now);
  p.look_at_recorder(now);
  p.control->serve([&p, now](std::string_view line) { return p.requests.handle(line, now); }, now);
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
  for (const Alert& alert : report.camera_alerts(cameras, now, grace))
    publish_and_log(alert, *map, now);
  for (const auto& news : report.camera_news(cameras)) log.event(news.key, news.text, now);
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
  const auto waited_s = in_s(now - started);
  return waited_s >= setup.config.service.startup_wait_s &&
         (all_tried || now - started >= kFirstStart);
}

void Daemon::Parts::publish_and_log(const Alert& alert, const MapIdentity& found_with, Stamp now) {
  telemetry.publish_alert(alert, setup.rig, found_with, now);
  const bool several_families = found_with.several_families;
  log.event(log_key(alert, setup.rig, several_families),
            alert_text(alert, setup.rig, several_families), now);
}

void Daemon::Parts::pass_on(const LocalizationNews& news, Stamp now) {
  for (const Alert& alert : news.alerts) {
    publish_and_log(alert, *news.map, now);
    std::erase_if(standing, [&](const Alert& other) { return same_subject(alert, other); });
    if (alert.raised) standing.push_back(alert);
  }
  if (news.quarantine_changed) {
    unused.set_found(news.map->map_hash, news.quarantine, telemetry.utime_us(now));
  }
  if (news.replaced) end_alerts_of_replaced(*news.map, now);
}

/// Ends the alerts that the replaced localization raised, for the next one does not know of them.
/// Of the same map read again, the quarantine stays, and with it the alerts of its markers.
void Daemon::Parts::end_alerts_of_replaced(const MapIdentity& replaced, Stamp now) {
  std::vector<Alert> kept;
  for (Alert& alert : std::exchange(standing, {})) {
    if (alert.marker && replaced.map_hash == map->map_hash) {
      kept.push_back(alert);
      continue;
    }
    alert.raised = false;
    alert.map_loaded = true;
    alert.stamp = now;
    publish_and_log(alert, replaced, now);
  }
  standing = std::move(kept);
}

void Daemon::Parts::tell_present(status_t& told) const {
  told.version = options.version;
  told.map_markers = static_cast<std::int32_t>(marker_count(setup));
  told.reload_refused = last_reload ? "" : last_reload.error().message;
  told.quarantined_markers = static_cast<std::int32_t>(unused.quarantined());
  const Recorder::State recording = recorder.state();
  told.recording = static_cast<std::int8_t>(recording.running());
  told.recording_path = recording.running() ? recording.folder.string() : "";
  told.recorded_sets = static_cast<std::int64_t>(recording.sets);
  told.recorded_bytes = static_cast<std::int64_t>(recording.bytes);
  told.recorder_drops = static_cast<std::int64_t>(recording.drops);
  told.map_hash = telemetry.session().map_hash;
}

void Daemon::Parts::publish_status(Stamp now) {
  const std::string poses = telemetry.take_pose_summary(now - last_status);
  report.fill(cameras, localization.counts(), now - last_status, status);
  last_status = now;
  tell_present(status);
  status.text = StatusReport::text(status, poses);
  if (const auto trouble = quarantine_file->trouble(); !trouble.empty()) {
    status.text += "; " + trouble;
  }
  telemetry.publish_status(status, now);
  look_at_link(now);
  // Whoever reads systemd's status may not get the messages that would say so.
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

void Daemon::Parts::look_at_quarantine_file(Stamp now) {
  for (const QuarantineFile::News& news : quarantine_file->take_news()) {
    telemetry.publish_alert("QUARANTINE", "", news.text, news.wrong, now);
    log.event(news.text, news.text, now);
  }
}

void Daemon::Parts::look_at_recorder(Stamp now) {
  recorder.set_date_known(telemetry.date_known());
  for (const RecordingNews& news : recordings.take_news()) {
    if (news.begun) localization.begin_tally();
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

void Daemon::reload() { parts_->begin_reload(); }

void Daemon::Parts::begin_reload() {
  // Before ready only the start itself ends in READY=1, which would have to end a reload as well.
  if (ready) notifier.reloading(monotonic_now());
  reloads.request();
}

Status Daemon::Parts::check_reload(const Setup& next) const {
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
  return {};
}

/// In the reload's thread. The setup is changed by swap alone, which takes what this gives.
Expected<Replacement> Daemon::Parts::prepare_reload() const {
  auto next = options.load_setup(options.config);
  if (!next) return tl::make_unexpected(next.error());
  if (auto fits = check_reload(*next); !fits) return tl::make_unexpected(fits.error());
  auto quarantined = quarantine_file->of_map(next->map_hash);
  MapInUse map = map_in_use(*next, quarantined);
  return Replacement{std::move(*next), std::move(map), std::move(quarantined)};
}

void Daemon::Parts::finish_reload(Expected<Replacement> next, Stamp now) {
  ++reloads_ended;
  last_reload = next ? Status{} : tl::make_unexpected(next.error());
  const std::string text = next ? "reloaded: " + options.config.string()
                                : "reload refused, all stays as it was: " + next.error().message;
  const bool refused = !next;
  if (next) swap(std::move(*next));
  telemetry.publish_alert("RELOAD", options.config.string(), text, refused, now);
  log.note(text);
  ready ? notifier.ready(text) : notifier.status(text);
}

void Daemon::Parts::swap(Replacement next) {
  map = next.map.identity;
  unused.use_map(map->map_hash, std::move(next.quarantine));
  setup = std::move(next.setup);
  for (const std::string& line : told_of(setup)) log.note(line);
  localization.swap_map(std::move(next.map));
  recorder.set_budget(recording_budget(setup.config.record));
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
  if (!p.reloads.settle(deadline)) {
    return fail(ErrorKind::unavailable, "a reload does not get its files; ending without");
  }
  return {};
}

}  // namespace waymark
