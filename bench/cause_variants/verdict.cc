#include <algorithm>
#include <cmath>

#include "bench/cause_variants/variant.h"

namespace waymark::bench {
namespace {

/// Says what a capture is good for, and accuses nobody.
bool is_a_limit(Cause cause) {
  return cause == Cause::few_views || cause == Cause::disconnected || cause == Cause::not_level ||
         cause == Cause::scale_unknown;
}

bool names_innocents(const Said::Line& line, const Truth& truth) {
  const auto guilty = [&](const std::string& marker) {
    return std::any_of(truth.markers.begin(), truth.markers.end(), [&](const MarkerId& id) {
      return marker == format_marker_id(id, false) || marker == format_marker_id(id, true);
    });
  };
  return !std::all_of(line.markers.begin(), line.markers.end(), guilty) ||
         !std::includes(truth.cameras.begin(), truth.cameras.end(), line.cameras.begin(),
                        line.cameras.end());
}

/// What counts of a line: accusations, and limits and notes where these are what ought to be said.
bool counts(const Said::Line& line, const Truth& truth) {
  if (truth.causes.contains(line.cause)) return line.severity <= truth.at_least;
  return line.severity != Severity::note && !is_a_limit(line.cause);
}

void judge_value(const Said::Line& line, const Truth& truth, Verdict& verdict) {
  verdict.value_known = truth.value && line.value;
  if (!verdict.value_known) return;
  constexpr double kSigmas = 4.0;
  const double within = std::max(truth.within, kSigmas * line.sigma.value_or(0));
  verdict.value_right = std::abs(*line.value - *truth.value) <= within;
}

}  // namespace

Verdict judged(const Said& said, const Truth& truth) {
  Verdict verdict;
  verdict.exit_right = truth.exits.contains(said.exit_code);
  for (const Said::Line& line : said.findings) {
    const bool accuses = line.severity != Severity::note && !is_a_limit(line.cause);
    if (accuses && names_innocents(line, truth)) verdict.innocent_named = true;
  }
  const auto first = std::find_if(said.findings.begin(), said.findings.end(),
                                  [&](const Said::Line& line) { return counts(line, truth); });
  if (first == said.findings.end()) return verdict;
  if (!truth.causes.contains(first->cause)) {
    verdict.told = Verdict::Told::wrong;
    return verdict;
  }
  verdict.told = Verdict::Told::right;
  judge_value(*first, truth, verdict);
  return verdict;
}

}  // namespace waymark::bench
