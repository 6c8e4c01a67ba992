#pragma once

#include <filesystem>
#include <ostream>

#include "locd/service/daemon.h"

namespace waymark {

/// Runs locd until SIGTERM or SIGINT; SIGHUP reloads. Returns the program's exit code.
[[nodiscard]] int run_daemon(const DaemonOptions& options);

/// `locd --check`: says what the configuration, rig, map and cameras are, or what is
/// wrong with them.
[[nodiscard]] Status check_configuration(const DaemonOptions& options, std::ostream& out,
                                         std::ostream& notes);

}  // namespace waymark
