#pragma once

#include <ostream>
#include <vector>

#include "core/base/error.h"
#include "mapbuilder/diagnosis/finding.h"

namespace waymark {

/// What the user wants done about findings.
struct FindingRules {
  bool strict = false;         ///< warnings are errors
  bool accept_errors = false;  ///< the result is written although errors stand against it
};

/// The findings as they count by the rules, the worst first.
[[nodiscard]] std::vector<Finding> judged(std::vector<Finding> findings, const FindingRules& rules);

/// Prints judged findings, one line per cause.
void print_findings(const std::vector<Finding>& findings, std::ostream& notes);

/// Whether the result may take its place: no finding is an error, or errors are accepted.
[[nodiscard]] bool may_stand(const std::vector<Finding>& judged_findings,
                             const FindingRules& rules);

/// What ends a command whose result may not stand: "hall.map: 2 errors stand against it; …".
[[nodiscard]] Error refusal_of(const std::string& result,
                               const std::vector<Finding>& judged_findings,
                               const std::string& what_was_done);

}  // namespace waymark
