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

Finding beyond_calibration_found(const RigCamera& camera, std::size_t count) {
  Finding finding;
  finding.severity = Severity::note;
  finding.cause = Cause::intrinsics;
  finding.subject = camera.name;
  finding.text = fmt::format(
      "{} left out: farther than {:.0f} px from its principal point the calibration says nothing.",
      detections(count), camera.model.valid_radius_px());
  finding.cameras = {camera.name};
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
  for (const CameraIndex c : observations.beyond_calibration.indices()) {
    const std::size_t count = observations.beyond_calibration[c];
    if (count == 0) continue;
    const CameraPlace& place = observations.cameras[c];
    findings.push_back(
        beyond_calibration_found(observations.rigs[place.rig].cameras[place.in_rig], count));
  }
  return findings;
}

}  // namespace waymark
