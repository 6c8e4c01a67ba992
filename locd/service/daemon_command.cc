#include "locd/service/daemon_command.h"

#include <fmt/ostream.h>
#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "core/base/notes.h"
#include "drivers/device_monitor.h"
#include "drivers/monotonic_clock.h"
#include "locd/frames/realtime.h"
#include "locd/publish/multicast_route.h"
#include "locd/record/recorder.h"
#include "locd/record/recording_archive.h"
#include "locd/service/camera_check.h"
#include "locd/service/camera_sources.h"
#include "locd/service/instance_lock.h"
#include "locd/service/standard_error.h"

namespace waymark {
namespace {

constexpr Stamp kTurn = std::chrono::milliseconds(100);
/// SIGTERM ends in a second, whatever drivers do.
constexpr Stamp kStopPatience = std::chrono::milliseconds(700);

/// Signals as a descriptor to poll; every thread that starts after this inherits the blocking.
int signals_as_descriptor() {
  sigset_t wanted;
  sigemptyset(&wanted);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&wanted, signal);
  ::pthread_sigmask(SIG_BLOCK, &wanted, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
  return ::signalfd(-1, &wanted, SFD_CLOEXEC | SFD_NONBLOCK);
}

std::filesystem::path lock_file(const DaemonOptions& options) {
  return options.runtime_folder / "locd.pid";
}

/// Held while this process has the state folder: what two wrote there would be neither's, whatever
/// their runtime folders.
std::filesystem::path state_lock_file(const DaemonOptions& options) {
  return options.state_folder / "locd.lock";
}

/// nullopt, with a note, where the system does not tell of devices.
std::optional<DeviceMonitor> open_device_monitor() {
  auto monitor = DeviceMonitor::open();
  if (monitor) return std::move(*monitor);
  offer_line(note_line(monitor.error().message));
  return std::nullopt;
}

/// What detecting markers in all of the rig's images takes (bytes): at most the 9 to 11 bytes a
/// pixel of a set that were measured of OpenCV's detector, whose place ours has taken; and what a
/// recording takes, its sets under way and one encoded.
std::size_t heap_needed(const Rig& rig) {
  constexpr std::size_t kBytesPerPixel = 13 + Recorder::kSlots + 1;
  std::size_t pixels = 0;
  for (const RigCamera& camera : rig.cameras) {
    const CameraParameters& size = camera.model.parameters();
    pixels += static_cast<std::size_t>(size.width_px) * static_cast<std::size_t>(size.height_px);
  }
  return kBytesPerPixel * pixels;
}

/// Ends the threads and gives back the exit code; the process, where something does not return.
int end(Daemon& daemon, int code) {
  const Status ended = daemon.stop(kStopPatience);
  if (ended) return code;
  offer_line(fmt::format("locd: {}", ended.error().message));
  std::fflush(nullptr);
  std::_Exit(code);
}

int report_failure(const Error& error) {
  offer_line(fmt::format("locd: {}", error.message));
  return error.exit_code();
}

/// Tells the daemon of devices that have come. A monitor that fails is closed, and that is said.
void take_device_events(std::optional<DeviceMonitor>& monitor, Daemon& daemon) {
  const auto came = monitor->device_came();
  if (came && *came) daemon.devices_came();
  if (came) return;
  offer_line(note_line(came.error().message));
  monitor.reset();
}

/// What the signals that have come ask for: all of them are taken, and many are as one.
struct SignalRequests {
  bool end = false;
  bool reload = false;
};
SignalRequests take_signals(int descriptor) {
  SignalRequests requests;
  signalfd_siginfo signal{};
  while (::read(descriptor, &signal, sizeof signal) == sizeof signal) {
    (signal.ssi_signo == SIGHUP ? requests.reload : requests.end) = true;
  }
  return requests;
}

/// Turns until a signal, or a camera that can't be meant, ends it; at once when somebody comes with
/// a request. A turn has at most one reload, however many signals come.
Status serve(Daemon& daemon, int signals, std::optional<DeviceMonitor>& monitor) {
  bool reload = false;
  for (Stamp due = monotonic_now();;) {
    if (std::exchange(reload, false)) daemon.reload();
    daemon.turn(monotonic_now());
    if (daemon.refusal()) return tl::make_unexpected(*daemon.refusal());
    // A pose that is due is not late by a turn.
    due = std::min(due + kTurn, daemon.telemetry().next_keep_alive());
    for (Stamp left = due - monotonic_now(); left > Stamp{0}; left = due - monotonic_now()) {
      pollfd watched[] = {{signals, POLLIN, 0},
                          {daemon.control_descriptor(), POLLIN, 0},
                          {monitor ? monitor->descriptor() : -1, POLLIN, 0}};
      const auto left_ms = std::chrono::ceil<std::chrono::milliseconds>(left).count();
      if (::poll(watched, 3, static_cast<int>(left_ms)) <= 0) continue;
      if (watched[1].revents != 0) due = monotonic_now();
      if (watched[2].revents != 0) take_device_events(monitor, daemon);
      const SignalRequests asked = take_signals(signals);
      if (asked.end) return {};
      reload = reload || asked.reload;
    }
  }
}

}  // namespace

int run_daemon(const DaemonOptions& options) {
  const int signals = signals_as_descriptor();
  auto setup = load_setup(options.config);
  if (!setup) return report_failure(setup.error());
  const auto lock = InstanceLock::take(lock_file(options));
  if (!lock) return report_failure(lock.error());
  const auto state_lock = InstanceLock::take(state_lock_file(options));
  if (!state_lock) return report_failure(state_lock.error());
  keep_heap(heap_needed(setup->rig));
  auto sources = make_sources(*setup);
  if (!sources) return report_failure(sources.error());
  auto daemon = std::make_unique<Daemon>(options, std::move(*setup), std::move(*sources));
  if (auto started = daemon->start(); !started)
    return end(*daemon, report_failure(started.error()));
  auto monitor = open_device_monitor();
  const Status served = serve(*daemon, signals, monitor);
  return end(*daemon, served ? 0 : report_failure(served.error()));
}

Status check_configuration(const DaemonOptions& options, std::ostream& out, std::ostream& notes) {
  const auto setup = load_setup(options.config);
  if (!setup) return tl::make_unexpected(setup.error());
  const auto sources = make_sources(*setup);
  if (!sources) return tl::make_unexpected(sources.error());
  for (const std::string& warning : shown_notes(setup->warnings)) {
    fmt::print(notes, "warning: {}\n", warning);
  }
  for (const std::string& note : shown_notes(setup->notes)) {
    fmt::print(notes, "{}\n", note_line(note));
  }
  if (const auto& dir = setup->config.record.dir; !dir.empty()) {
    const auto note = check_archive(dir);
    if (!note) return tl::make_unexpected(note.error());
    if (*note) fmt::print(notes, "{}\n", note_line(in_one_line(**note)));
  }
  fmt::print(out, "{}\n", describe_route(*parse_lcm_url(setup->config.lcm.url)));
  if (setup->key) {
    fmt::print(out, "poses are signed with {}\n", in_one_line(setup->config.lcm.key_file.string()));
  }
  const auto owner = InstanceLock::holder(lock_file(options));
  if (auto checked = check_cameras(*sources, owner, out); !checked) return checked;
  fmt::print(out, "{}: {} cameras, {} markers{}; {}\n", in_one_line(options.config.string()),
             setup->rig.cameras.size(), setup->map ? setup->map->submaps.front().markers.size() : 0,
             setup->map ? ", map " + setup->map_hash : std::string(", no map"),
             setup->warnings.empty() ? "all is well" : "runs, but heed the warning");
  return {};
}

}  // namespace waymark
