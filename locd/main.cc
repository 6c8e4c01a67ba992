#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>

#include "locd/replay_command.h"

namespace waymark {
namespace {

std::atomic<bool> stop_requested{false};  // a signal handler can reach nothing else

void request_stop(int /*signal*/) { stop_requested = true; }

int run(int argc, char** argv) {
  CLI::App app{"locd: tells a vehicle where it is, by the markers its cameras see"};
  app.set_version_flag("--version", WAYMARK_VERSION);
  ReplayCommandOptions replay;
  auto* group = app.add_option_group("replay", "a capture in place of cameras");
  auto* capture = group->add_option("--replay", replay.capture, "capture folder")->required();
  group->add_option("--map", replay.map, "map file")->required()->needs(capture);
  group->add_option("--trajectory", replay.trajectory, "poses to write (TUM)")->needs(capture);
  group->add_option("--table", replay.table, "all of every pose to write (CSV)")->needs(capture);
  group->add_flag("--loop", replay.loop, "again and again, until stopped")->needs(capture);
  group->add_flag("--realtime", replay.realtime, "at the capture's own pace")->needs(capture);
  group->add_flag("--redetect", replay.redetect, "detect even where detections.csv exists")
      ->needs(capture);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    app.exit(error, std::cerr, std::cerr);
    return static_cast<int>(ErrorKind::usage);
  }
  const Status status = run_replay(replay, stop_requested, std::cout, std::cerr);
  if (status) return 0;
  fmt::print(stderr, "locd: {}\n", status.error().message);
  return status.error().exit_code();
}

}  // namespace
}  // namespace waymark

int main(int argc, char** argv) {
  std::signal(SIGINT, waymark::request_stop);
  std::signal(SIGTERM, waymark::request_stop);
  try {
    return waymark::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "locd: internal error: %s\n", error.what());
    return static_cast<int>(waymark::ErrorKind::internal);
  }
}
