#pragma once

#include <filesystem>
#include <iosfwd>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "core/base/error.h"

namespace waymark {

/// What locdctl was told to do.
struct LocdctlOptions {
  std::filesystem::path control;                ///< socket
  bool json = false;                            ///< print what locd answers as JSON
  std::string request;                          ///< "status", "start"…
  std::string argument;                         ///< what stands behind it; empty: nothing
  std::optional<std::filesystem::path> output;  ///< of calibration: the rig file to write
  double timeout_s = 20;                        ///< locd itself gives up after 10
};

/// Makes the request and prints its answer to `out`, what is only said to `notes`. Errors: those of
/// ask_locd and write_file_atomically.
[[nodiscard]] Status run_locdctl(const LocdctlOptions& options, std::ostream& out,
                                 std::ostream& notes);

/// How locd is, for people: a line on poses, one per camera, one on the recording, and what else is
/// not as it should be. `status`: what locd answers to a request of that name.
[[nodiscard]] std::string describe_status(const nlohmann::ordered_json& status);

}  // namespace waymark
