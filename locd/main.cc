#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <memory>

#include "core/base/standard_output.h"
#include "core/base/usage_text.h"
#include "locd/service/camera_list.h"
#include "locd/service/daemon_command.h"
#include "locd/service/replay_command.h"
#include "manual/plain_help.h"

namespace waymark {
namespace {

std::atomic<bool> stop_requested{false};  // a signal handler can reach nothing else

void request_stop(int /*signal*/) { stop_requested = true; }

void add_replay_options(CLI::App& app, ReplayCommandOptions& replay) {
  auto* capture = app.add_option("--replay", replay.capture, "a capture in place of cameras");
  auto* map = app.add_option("--map", replay.map, "map file")->needs(capture);
  capture->needs(map);
  app.add_option("--trajectory", replay.trajectory, "poses to write (TUM)")->needs(capture);
  app.add_option("--table", replay.table, "all of every pose to write (CSV)")->needs(capture);
  app.add_flag("--loop", replay.loop, "again and again, until stopped")->needs(capture);
  app.add_flag("--realtime", replay.realtime, "at the capture's own pace")->needs(capture);
  app.add_flag("--redetect", replay.redetect, "detect even where detections.csv exists")
      ->needs(capture);
}

void add_daemon_options(CLI::App& app, DaemonOptions& daemon, bool& check) {
  auto* config = app.add_option("--config", daemon.config, "run as the configuration file says");
  app.add_flag("--check", check, "only validate configuration, rig and map")->needs(config);
  app.add_option("--record", daemon.record, "record from the start, into this folder")
      ->needs(config);
}

/// The exit code that says how it went, and a line on stderr when it went wrong, also with what was
/// printed.
int report(const Status& status) {
  if (status) return exit_code_after_output(0, "locd");
  std::cerr << line_of(status.error(), "locd") << '\n';
  return status.error().exit_code();
}

int run(int argc, char** argv) {
  CLI::App app{"locd: tells a vehicle where it is, by the markers its cameras see"};
  app.formatter(std::make_shared<PlainHelp>());
  app.failure_message(
      [](const CLI::App*, const CLI::Error& error) { return usage_text(error.what()); });
  app.set_version_flag("--version", WAYMARK_VERSION);
  ReplayCommandOptions replay;
  add_replay_options(app, replay);
  DaemonOptions daemon = options_from_environment();
  daemon.version = WAYMARK_VERSION;
  bool check = false;
  bool list = false;
  add_daemon_options(app, daemon, check);
  app.add_flag("--list-cameras", list, "print a [[camera]] block per camera that is plugged in");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return exit_code_after_output(app.exit(success), "locd");
  } catch (const CLI::ParseError& error) {
    app.exit(error, std::cerr, std::cerr);
    return static_cast<int>(ErrorKind::usage);
  }
  if (list) {
    const auto system = kernel_video_system();
    return report(list_cameras(*system, libcamera_cameras(*system), std::cout));
  }
  const bool replays = app.count("--replay") > 0;
  if (replays == (app.count("--config") > 0)) {
    std::cerr << "locd: --config FILE, --replay CAPTURE --map MAP or --list-cameras; see --help\n";
    return static_cast<int>(ErrorKind::usage);
  }
  if (check) return report(check_configuration(daemon, std::cout, std::cerr));
  if (!replays) return run_daemon(daemon);
  std::signal(SIGINT, request_stop);
  std::signal(SIGTERM, request_stop);
  return report(run_replay(replay, stop_requested, std::cout, std::cerr));
}

}  // namespace
}  // namespace waymark

int main(int argc, char** argv) {
  try {
    return waymark::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "locd: internal error: %s\n", waymark::in_one_line(error.what()).c_str());
    return static_cast<int>(waymark::ErrorKind::internal);
  }
}
