#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bench/cause_variants/world.h"
#include "mapbuilder/build/world_frame.h"
#include "mapbuilder/diagnosis/finding.h"

namespace waymark::bench {

/// What ought to be said of a variant.
struct Truth {
  std::set<Cause> causes;         ///< any of them comes first; empty: nothing is wrong
  std::set<std::string> cameras;  ///< that may be named
  std::set<MarkerId> markers;     ///< that may be named
  std::optional<double> value;    ///< of the finding's first figure
  double within = 0;              ///< of the value, or four of its sigmas where that is more
  Severity at_least = Severity::warning;
  std::set<int> exits = {0, 65};
};

/// One capture as its user has it, or thinks to have it.
struct Variant {
  std::vector<World> worlds;  ///< one capture each, the first is the faulty one
  /// Changes what the first capture's cameras saw.
  std::vector<std::function<void(std::vector<ImageDetections>&)>> on_images;
  /// Changes the first capture's files as they are written.
  std::function<void(std::string&)> on_csv, on_rig, on_markers;
  std::string survey_toml;
  std::string hand_map_json;  ///< not empty: imported, and the capture localized in it
  std::optional<LevelBy> level;
  Truth truth;

  [[nodiscard]] World& world() { return worlds.front(); }
  [[nodiscard]] const World& world() const { return worlds.front(); }
};

/// What a program said: the findings in the order in which they were told, and its exit code.
struct Said {
  struct Line {
    Severity severity = Severity::note;
    Cause cause = Cause::few_views;
    std::string subject;
    std::set<std::string> cameras, markers;
    std::optional<double> value, sigma;
  };
  std::vector<Line> findings;
  int exit_code = 0;
  double cpu_s = 0;
  std::string output;  ///< as on the terminal
};

/// Writes the variant below `folder`, which is emptied first, and runs `mapbuilder build`, or
/// `import` and `localize`, in this process.
[[nodiscard]] Said run_variant(const Variant& variant, const std::filesystem::path& folder);

/// How what was said compares to the truth.
struct Verdict {
  enum class Told { right, wrong, nothing } told = Told::nothing;
  bool innocent_named = false;
  bool value_known = false;  ///< truth and finding have one
  bool value_right = false;
  bool exit_right = false;
};

[[nodiscard]] Verdict judged(const Said& said, const Truth& truth);

}  // namespace waymark::bench
