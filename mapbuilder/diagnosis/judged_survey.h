#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/import/survey.h"

namespace waymark {

/// A survey without what contradicts the rest.
struct JudgedSurvey {
  Survey survey;  ///< entries that stand alone are left_out: they bend nothing
  std::vector<Finding> findings;
  /// What all stated sizes must be multiplied by, where more sides speak against them than for
  /// them; nullopt: they stand.
  std::optional<double> sizes_times;
  bool z_is_up = true;  ///< nothing says that the survey's third axis is another one

  /// One more finding, the rest of which may be filled in until the next is added.
  Finding& add(Cause cause, Severity severity, std::string subject, std::string text,
               std::string remedy) {
    Finding& finding = findings.emplace_back();
    finding.cause = cause;
    finding.severity = severity;
    finding.subject = std::move(subject);
    finding.text = std::move(text);
    finding.remedy = std::move(remedy);
    return finding;
  }
};

}  // namespace waymark
