#include "mapbuilder/diagnosis/lens_evidence.h"

#include <fmt/format.h>

#include <cmath>

#include "mapbuilder/diagnosis/lens_causes.h"

namespace waymark {
namespace {

/// Numbers of another camera altogether are an error, however well markers' own poses hide it.
bool is_gross(const LensExplanation& why) {
  constexpr double kGrossFocal = 5.0;  // %
  return why.cause != Cause::intrinsics || (why.unit == "%" && std::abs(why.value) > kGrossFocal) ||
         why.detail.find("[cx cy fx fy]") != std::string::npos;
}

Finding finding_of(const LensExplanation& why, const CameraAlone& alone, const std::string& camera,
                   const std::string& capture) {
  Finding finding;
  finding.severity = Severity::error;
  finding.cause = why.cause;
  finding.subject = camera;
  finding.cameras = {camera};
  finding.captures = {capture};
  finding.text = fmt::format("{} (its images alone: {:.2f} px as stated, {:.2f} px so).",
                             why.detail, alone.stated.joint_px, alone.fitted.joint_px);
  finding.remedy = why.remedy;
  finding.figures = {{"fitted", why.value, why.unit, {}}};
  return finding;
}

}  // namespace

LensEvidence lens_evidence(const DetectedCapture& capture, const BuildOptions& options) {
  LensEvidence evidence;
  for (std::size_t k = 0; k < capture.rig.cameras.size(); ++k) {
    evidence.push_back(fit_camera_alone(capture, k, options));
  }
  return evidence;
}

DetectedCapture with_fitted_lenses(DetectedCapture capture, const LensEvidence& evidence) {
  for (std::size_t k = 0; k < evidence.size(); ++k) {
    if (!evidence[k] || !evidence[k]->fits_better()) continue;
    auto model = CameraModel::create(evidence[k]->parameters);
    if (model) capture.rig.cameras[k].model = *std::move(model);
  }
  return capture;
}

std::vector<Finding> correct_lenses(const LensEvidence& evidence, DetectedCapture& capture) {
  std::vector<Finding> findings;
  for (std::size_t k = 0; k < evidence.size(); ++k) {
    const auto& alone = evidence[k];
    if (!alone || !alone->misfits()) continue;
    RigCamera& camera = capture.rig.cameras[k];
    const auto why = explain_lens(camera.model.parameters(), alone->parameters);
    auto model = CameraModel::create(alone->parameters);
    if (!why || !model || (!alone->stated.contradicts() && !is_gross(*why))) continue;
    camera.model = *std::move(model);
    findings.push_back(finding_of(*why, *alone, camera.name, capture.name));
  }
  return findings;
}

}  // namespace waymark
