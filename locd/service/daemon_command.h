#pragma once

#include <filesystem>

#include "locd/service/daemon.h"

namespace waymark {

/// Runs locd until SIGTERM or SIGINT; SIGHUP reloads. Returns the program's exit code.
[[nodiscard]] int run_daemon(const DaemonOptions& options);

/// `locd --check`: says on stdout what the configuration, rig, map and cameras are, or what is
/// wrong with them.
[[nodiscard]] Status check_configuration(const DaemonOptions& options);

}  // namespace waymark
