#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <iostream>
#include <memory>

#include "core/base/standard_output.h"
#include "core/base/usage_text.h"
#include "locd/control/control_client.h"
#include "locd/control/locdctl_command.h"
#include "manual/plain_help.h"

namespace waymark {
namespace {

CLI::App& add_request(CLI::App& app, LocdctlOptions& options, const char* word, const char* what) {
  auto* sub = app.add_subcommand(word, what);
  sub->callback([&options, word] { options.request = word; });
  return *sub;
}

void add_requests(CLI::App& app, LocdctlOptions& options) {
  add_request(app, options, "status", "say how locd is: poses, cameras, recording");
  add_request(app, options, "start", "start a recording, in a folder of its own")
      .add_option("NAME", options.argument, "stands behind the date in the folder's name");
  add_request(app, options, "stop", "end the recording, once all of it is on the disk");
  add_request(app, options, "mark", "note this instant in the recording's marks.csv")
      .add_option("TEXT", options.argument, "what happened");
  add_request(app, options, "reload", "read [map], [solve] and [record] of locd.toml again");
  add_request(app, options, "release", "use a marker again that locd has put into quarantine")
      .add_option("ID", options.argument, "12, or tag36h11:12 where several families meet")
      ->required();
  add_request(app, options, "ignore", "leave a marker out of everything until it is allowed")
      .add_option("ID", options.argument, "12, or tag36h11:12 where several families meet")
      ->required();
  add_request(app, options, "allow", "use an ignored marker again")
      .add_option("ID", options.argument, "12, or tag36h11:12 where several families meet")
      ->required();
  add_request(app, options, "calibration", "give the calibration of the rig that is in use")
      .add_option("-o,--output", options.output, "rig file to write; default: standard output");
}

int run(int argc, char** argv) {
  CLI::App app("Tells a locd that runs what to do, and asks it how it is.", "locdctl");
  app.formatter(std::make_shared<PlainHelp>());
  app.failure_message(
      [](const CLI::App*, const CLI::Error& error) { return usage_text(error.what()); });
  app.set_version_flag("--version", WAYMARK_VERSION);
  app.require_subcommand(1);
  app.fallthrough();
  LocdctlOptions options;
  options.control = default_control_socket();
  app.add_option("--control", options.control, "locd's socket; /run/locd/control if not said");
  app.add_flag("--json", options.json, "print what locd answers as JSON");
  app.add_option("--timeout", options.timeout_s, "how long to wait for the answer, s")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  add_requests(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const bool asked_for_help = app.exit(error) == 0;
    return asked_for_help ? exit_code_after_output(0, app.get_name())
                          : static_cast<int>(ErrorKind::usage);
  }
  const Status status = run_locdctl(options, std::cout, std::cerr);
  if (status) return exit_code_after_output(0, app.get_name());
  std::cerr << line_of(status.error(), app.get_name()) << '\n';
  return status.error().exit_code();
}

}  // namespace
}  // namespace waymark

int main(int argc, char** argv) {
  try {
    return waymark::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "locdctl: internal error: %s\n",
                 waymark::in_one_line(error.what()).c_str());
    return static_cast<int>(waymark::ErrorKind::internal);
  }
}
