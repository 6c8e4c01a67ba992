#include "mapbuilder/diagnosis/observation_findings.h"

#include <fmt/format.h>

namespace waymark {
namespace {

std::string detections(std::size_t count) {
  return fmt::format("{} detection{}", count, count == 1 ? "" : "s");
}

Finding repeated_found(std::size_t count) {
  Finding finding;
  finding.cause = Cause::twin;
  finding.subject = detections(count);
  finding.text =
      "left out: their id was found twice in one image, and neither of two markers with one id can "
      "be trusted.";
  finding.remedy = "Check whether a marker is printed twice.";
  finding.figures = {{"detections left out", static_cast<double>(count), "", {}}};
  return finding;
}

Finding degenerate_found(std::size_t count) {
  Finding finding;
  finding.severity = Severity::note;
  finding.cause = Cause::wrong_id;
  finding.subject = detections(count);
  finding.text =
      "left out: their corners are no view of a square; they lie outside the lens's domain, or "
      "cross.";
  finding.figures = {{"detections left out", static_cast<double>(count), "", {}}};
  return finding;
}

}  // namespace

std::vector<Finding> observation_findings(const Observations& observations) {
  std::vector<Finding> findings;
  if (observations.repeated_in_image > 0) {
    findings.push_back(repeated_found(observations.repeated_in_image));
  }
  if (observations.degenerate > 0) findings.push_back(degenerate_found(observations.degenerate));
  return findings;
}

}  // namespace waymark
