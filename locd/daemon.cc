#include "locd/daemon.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <cstdlib>
#include <future>

#include "drivers/monotonic_clock.h"
#include "locd/instance_lock.h"
#include "locd/localization_thread.h"
#include "locd/rig_capture.h"
#include "locd/service_log.h"
#include "locd/service_notifier.h"
#include "locd/status_report.h"

namespace waymark {
namespace {

constexpr Stamp kTurn = std::chrono::milliseconds(100);
constexpr Stamp kStatusPeriod = std::chrono::seconds(1);
/// A thread that has not turned for so long is stuck. Localizing one set takes a tenth of it on a
/// slow machine, and cameras turn five times a second.
constexpr Stamp kStuck = std::chrono::seconds(3);
/// SIGTERM ends in a second, whatever drivers do.
constexpr Stamp kStopPatience = std::chrono::milliseconds(700);

MapInUse map_in_use(const Setup& setup) {
  MapInUse map;
  map.time_budget =
      std::chrono::microseconds(std::llround(setup.config.solve.time_budget_ms * 1e3));
  if (!setup.map) return map;
  map.map_hash = setup.map_hash;
  map.world_z_is_up = setup.map->submaps.front().frame == FrameKind::facility;
  map.several_families = setup.map->several_families();
  map.localizer =
      std::make_unique<Localizer>(setup.rig, *setup.map, localizer_options(setup.config));
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
        telemetry(setup.config.lcm, session_of(setup, map), read_clocks()),
        capture(std::move(sources), sync_options(setup.config)),
        localization(capture, telemetry, std::move(map), [](const FrameSetLease&) {}),
        report(setup.rig) {}

  DaemonOptions options;
  Setup setup;
  bool several_families;
  Telemetry telemetry;
  RigCapture capture;
  LocalizationThread localization;
  StatusReport report;
  ServiceNotifier notifier;
  ServiceLog log;
  status_t status{};
  std::vector<RigCapture::CameraState> cameras;
  std::string reload_refused;
  Stamp started{0};
  Stamp last_status{0};
  bool ready = false;

  void look_at_cameras(Stamp now);
  void pass_on(const std::vector<Alert>& alerts, Stamp now);
  void publish_status(Stamp now);
  void feed_watchdog(Stamp now);
  Status swap(Setup next);
};

Daemon::Daemon(DaemonOptions options, Setup setup,
               std::vector<std::unique_ptr<FrameSource>> sources) {
  MapInUse map = map_in_use(setup);
  parts_ = std::make_unique<Parts>(std::move(options), std::move(setup), std::move(map),
                                   std::move(sources));
}

Daemon::~Daemon() = default;

Telemetry& Daemon::telemetry() { return parts_->telemetry; }

int Daemon::control_descriptor() const { return -1; }

Status Daemon::start() {
  Parts& p = *parts_;
  for (const std::string& note : p.setup.notes) p.log.note(note);
  p.started = p.last_status = monotonic_now();
  p.capture.start();
  p.localization.start();
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
  if (now - p.last_status >= kStatusPeriod) p.publish_status(now);
  p.feed_watchdog(now);
  p.log.summarize(now);
}

void Daemon::Parts::look_at_cameras(Stamp now) {
  cameras.clear();
  for (std::size_t c = 0; c < setup.rig.cameras.size(); ++c) cameras.push_back(capture.state(c));
  const Stamp grace = std::chrono::seconds(2);
  pass_on(report.camera_alerts(cameras, now, grace), now);
  bool all_run = true;
  for (const auto& camera : cameras) all_run = all_run && camera.running;
  const auto waited = std::chrono::duration<double>(now - started).count();
  if (!ready && (all_run || waited >= setup.config.service.startup_wait_s)) {
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
  status.map_hash = telemetry.session().map_hash;
  status.text = StatusReport::text(status, cameras);
  telemetry.publish_status(status, now);
  if (ready) notifier.status(status.text);
  if (!telemetry.connected()) {
    log.event("LCM", "LCM takes no messages; is there a route for multicast? Trying on", now);
  }
}

void Daemon::Parts::feed_watchdog(Stamp now) {
  bool all_turn = now - localization.counts().last_turn < kStuck || now - started < kStuck;
  for (const auto& camera : cameras) {
    all_turn = all_turn && (now - camera.last_turn < kStuck || now - started < kStuck);
  }
  if (all_turn) {
    notifier.feed_watchdog();
  } else {
    log.event("STUCK", "a thread does not turn; the watchdog is not fed", now);
  }
}

void Daemon::reload() {
  Parts& p = *parts_;
  const Stamp now = monotonic_now();
  p.notifier.reloading(now);
  auto next = load_setup(p.options.config);
  const Status swapped = next ? p.swap(std::move(*next)) : tl::make_unexpected(next.error());
  p.reload_refused = swapped ? "" : swapped.error().message;
  const std::string text = swapped ? "reloaded: " + p.options.config.string()
                                   : "reload refused, all stays as it was: " + p.reload_refused;
  p.telemetry.publish_alert("RELOAD", p.options.config.string(), text, !swapped, now);
  p.log.note(text);
  p.notifier.ready(text);
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
  MapInUse map = map_in_use(next);
  several_families = map.several_families;
  setup = std::move(next);
  localization.swap_map(std::move(map));
  return {};
}

bool Daemon::stop(Stamp patience) {
  Parts& p = *parts_;
  p.notifier.stopping();
  // In a thread of its own: a driver's call that never returns must not hold up the end.
  auto ended = std::make_shared<std::promise<void>>();
  auto waiting = ended->get_future();
  std::thread([&p, ended] {
    p.capture.stop();
    p.localization.stop();
    ended->set_value();
  }).detach();
  return waiting.wait_for(patience) == std::future_status::ready;
}

namespace {

/// Signals as a descriptor to poll; every thread that starts after this inherits the blocking.
int signals_as_descriptor() {
  sigset_t wanted;
  sigemptyset(&wanted);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&wanted, signal);
  ::pthread_sigmask(SIG_BLOCK, &wanted, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
  return ::signalfd(-1, &wanted, SFD_CLOEXEC | SFD_NONBLOCK);
}

int report_failure(const Error& error) {
  fmt::print(stderr, "locd: {}\n", error.message);
  return error.exit_code();
}

/// Turns until a signal ends it.
void serve(Daemon& daemon, int signals) {
  for (Stamp due = monotonic_now();; due += kTurn) {
    daemon.turn(monotonic_now());
    for (Stamp left = due + kTurn - monotonic_now(); left > Stamp{0};
         left = due + kTurn - monotonic_now()) {
      pollfd watched[] = {{signals, POLLIN, 0}, {daemon.control_descriptor(), POLLIN, 0}};
      const auto left_ms = std::chrono::ceil<std::chrono::milliseconds>(left).count();
      if (::poll(watched, 2, static_cast<int>(left_ms)) <= 0) continue;
      signalfd_siginfo signal{};
      while (::read(signals, &signal, sizeof signal) == sizeof signal) {
        if (signal.ssi_signo != SIGHUP) return;
        daemon.reload();
      }
    }
  }
}

}  // namespace

int run_daemon(const DaemonOptions& options) {
  const int signals = signals_as_descriptor();
  auto setup = load_setup(options.config);
  if (!setup) return report_failure(setup.error());
  const auto lock = InstanceLock::take(options.runtime_folder / "locd.pid");
  if (!lock) return report_failure(lock.error());
  auto sources = make_sources(*setup);
  if (!sources) return report_failure(sources.error());
  auto daemon = std::make_unique<Daemon>(options, std::move(*setup), std::move(*sources));
  if (auto started = daemon->start(); !started) return report_failure(started.error());
  serve(*daemon, signals);
  if (daemon->stop(kStopPatience)) return 0;
  fmt::print(stderr, "locd: a driver does not return; ending without it\n");
  std::fflush(nullptr);
  std::_Exit(0);
}

Status check_configuration(const std::filesystem::path& config) {
  const auto setup = load_setup(config);
  if (!setup) return tl::make_unexpected(setup.error());
  const auto sources = make_sources(*setup);
  if (!sources) return tl::make_unexpected(sources.error());
  for (const std::string& note : setup->notes) fmt::print(stderr, "note: {}\n", note);
  fmt::print("{}: {} cameras, {} markers{}; all is well\n", config.string(),
             setup->rig.cameras.size(), marker_count(*setup),
             setup->map ? ", map " + setup->map_hash : std::string(", no map"));
  return {};
}

}  // namespace waymark
