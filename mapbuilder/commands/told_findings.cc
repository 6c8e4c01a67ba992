#include "mapbuilder/commands/told_findings.h"

#include <fmt/ostream.h>

namespace waymark {

std::vector<Finding> judged(std::vector<Finding> findings, const FindingRules& rules) {
  for (Finding& finding : findings) {
    if (rules.strict && finding.severity == Severity::warning) finding.severity = Severity::error;
  }
  sort_worst_first(findings);
  return findings;
}

void print_findings(const std::vector<Finding>& findings, std::ostream& notes) {
  for (const std::string& line : lines_per_cause(findings)) fmt::print(notes, "{}\n", line);
}

bool may_stand(const std::vector<Finding>& judged_findings, const FindingRules& rules) {
  return rules.accept_errors || count_of(Severity::error, judged_findings) == 0;
}

Error refusal_of(const std::string& result, const std::vector<Finding>& judged_findings,
                 const std::string& what_was_done) {
  const std::size_t errors = count_of(Severity::error, judged_findings);
  return Error{
      ErrorKind::bad_data,
      fmt::format("{}: {} against it; {}; --accept-errors would write it all the same", result,
                  errors == 1 ? "an error stands" : fmt::format("{} errors stand", errors),
                  what_was_done)};
}

}  // namespace waymark
