#include "locd/daemon_command.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <cstdlib>

#include "drivers/monotonic_clock.h"
#include "locd/instance_lock.h"

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
             setup->rig.cameras.size(), setup->map ? setup->map->submaps.front().markers.size() : 0,
             setup->map ? ", map " + setup->map_hash : std::string(", no map"));
  return {};
}

}  // namespace waymark
