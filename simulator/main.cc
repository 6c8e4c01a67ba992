#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <map>
#include <memory>
#include <string>

#include "core/base/standard_output.h"
#include "core/base/usage_text.h"
#include "manual/plain_help.h"
#include "simulator/commands.h"

namespace {

std::atomic<bool> interrupted{false};

extern "C" void note_interrupt(int /*signal*/) { interrupted = true; }

constexpr int kUsage = 64;

}  // namespace

int main(int argc, char** argv) {
  using namespace waymark::simulator;  // NOLINT(google-build-using-namespace)
  std::signal(SIGINT, note_interrupt);
  std::signal(SIGTERM, note_interrupt);

  CLI::App app{"Makes captures of buildings with markers, with the truth beside them."};
  app.formatter(std::make_shared<waymark::PlainHelp>());
  app.failure_message(
      [](const CLI::App*, const CLI::Error& error) { return waymark::usage_text(error.what()); });
  app.require_subcommand(1);
  auto* list = app.add_subcommand("list", "The scenes and rigs that are built in");
  RenderOptions render_options;
  add_render_command(app, render_options);
  DetectionsOptions detections_options;
  add_detections_command(app, detections_options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? waymark::exit_code_after_output(0, "simulator") : kUsage;
  }
  const auto run = [&] {
    if (list->parsed()) return run_list();
    if (app.got_subcommand("render")) return run_render(render_options, interrupted);
    return run_detections(detections_options, interrupted);
  };
  return waymark::exit_code_after_output(run(), "simulator");
}
