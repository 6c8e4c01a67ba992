#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/cause.h"
#include "core/marker/marker_id.h"

namespace waymark {

/// How much a finding matters, the worst first.
enum class Severity {
  error,    ///< the result must not be used
  warning,  ///< kept from harming the rest, or limits what the result is good for
  note,     ///< worth knowing
};

[[nodiscard]] std::string_view name_of(Severity severity);

/// A number with its unit, as evidence: {"stated size", 0.150, "m"}.
struct Figure {
  std::string name;             ///< plain words, lower case
  double value = 0;             ///< in `unit`
  std::string unit;             ///< "m", "px", "°", "%", "σ", "s"; empty for a count
  std::optional<double> sigma;  ///< one standard deviation, in `unit`
};

/// Something that is wrong, or that limits the result, with its evidence.
struct Finding {
  Severity severity = Severity::warning;
  Cause cause = Cause::few_views;
  std::string subject;                ///< whom it concerns: "marker 44", "cam1, cam2", a file
  std::string text;                   ///< plain words: what is the matter, how sure that is
  std::string remedy;                 ///< plain words: what to do; may be empty for a note
  std::string explains;               ///< what of the data it accounts for; may be empty
  std::vector<Figure> figures;        ///< the first is the finding's value
  std::vector<MarkerId> markers;      ///< concerned, rising; sound ones are never named
  std::vector<std::string> cameras;   ///< concerned: cam0, cam1, …
  std::vector<std::string> captures;  ///< concerned, by name
  std::optional<std::size_t> submap;  ///< concerned, index in the map
};

/// "marker 12", "markers 3, 12"; at most 30 ids, then how many there are in all.
[[nodiscard]] std::string subject_of(const std::vector<MarkerId>& markers, bool with_family);

/// "34.6 ± 0.6 mm": as many decimals as the standard deviation's first digit needs, `decimals` at
/// least.
[[nodiscard]] std::string give_or_take(double value, double sigma, const char* unit, int decimals);

/// "SEVERITY [cause] subject: text remedy"
[[nodiscard]] std::string one_line(const Finding& finding);

/// The worst first; otherwise in the order in which they were found.
void sort_worst_first(std::vector<Finding>& findings);

/// What a terminal shows of findings that are sorted so: one line per cause, that of its worst; it
/// counts the others.
[[nodiscard]] std::vector<std::string> lines_per_cause(const std::vector<Finding>& findings);

[[nodiscard]] std::size_t count_of(Severity severity, const std::vector<Finding>& findings);

}  // namespace waymark
