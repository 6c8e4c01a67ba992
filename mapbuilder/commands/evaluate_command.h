#pragma once

#include <filesystem>
#include <optional>
#include <ostream>

#include "core/base/error.h"

namespace waymark {

/// `mapbuilder evaluate --map MAP [--trajectory TUM] --truth CAPTURE/groundtruth [--json]`
struct EvaluateOptions {
  std::filesystem::path map;
  std::optional<std::filesystem::path> trajectory;
  std::filesystem::path
      truth;  ///< a capture's groundtruth/; of mono trajectories, its ../rig.yaml too
  bool json = false;
};

/// Compares a map, and a trajectory, with the truth; results on `out`. Errors: no_input (no truth;
/// no such trajectory, or no truth for it), bad_data (unreadable ones; no marker of the map is in
/// the truth; no pose of the trajectory within 1 ms of a true one), those of read_map_file.
[[nodiscard]] Status run_evaluate(const EvaluateOptions& options, std::ostream& out);

}  // namespace waymark
