#include "mapbuilder/diagnosis/lens_evidence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mapbuilder/diagnosis/lens_causes.h"
#include "mapbuilder/diagnosis/square_equations.h"
#include "mapbuilder/growth/frame_set_localization.h"

namespace waymark {
namespace {

/// Numbers of another camera altogether are an error, however well markers' own poses hide it.
bool is_gross(const LensExplanation& why) {
  constexpr double kGrossFocal = 5.0;  // %
  return why.cause != Cause::intrinsics || (why.unit == "%" && std::abs(why.value) > kGrossFocal) ||
         why.detail.find("[cx cy fx fy]") != std::string::npos;
}

Finding finding_of(const LensExplanation& why, const CameraLens& alone, const std::string& camera,
                   const std::string& capture) {
  Finding finding;
  finding.severity = Severity::error;
  finding.cause = why.cause;
  finding.subject = camera;
  finding.cameras = {camera};
  finding.captures = {capture};
  finding.text = fmt::format("{} (images alone: {:.2f} px as stated, {:.2f} px so).", why.detail,
                             alone.stated.joint_px, alone.fitted.joint_px);
  finding.remedy = why.remedy;
  finding.figures = {{"fitted", why.value, why.unit, {}}};
  return finding;
}

bool are_alike(const CameraParameters& a, const CameraParameters& b) {
  return a.fu_px == b.fu_px && a.fv_px == b.fv_px && a.pu_px == b.pu_px && a.pv_px == b.pv_px &&
         a.coefficients == b.coefficients && a.distortion == b.distortion;
}

/// How well a camera's images fit the estimate's markers when they are localized by another lens.
FitQuality localized_by(const CameraModel& lens, const Selection& selection, Estimate estimate,
                        RigIndex rig, const BuildOptions& options) {
  const Observations& observations = selection.observations();
  estimate.calibration.rigs[rig].cameras.front().model = lens;
  std::vector<FrameSetIndex> images;
  for (const FrameSetIndex f : observations.frame_sets.indices()) {
    if (observations.frame_sets[f].rig != rig) continue;
    images.push_back(f);
    estimate.world_from_rig[f].reset();
  }
  const MapperOptions counted = effective(options);
  const PreparedObservations prepared(selection, estimate, counted.threads);
  return fit_quality(selection, localize(prepared, images, counted, std::move(estimate)), rig);
}

}  // namespace

LensesBySquares judge_lenses(const std::vector<DetectedCapture>& captures) {
  LensesBySquares lenses;
  for (const DetectedCapture& capture : captures) {
    auto& of_capture = lenses.emplace_back();
    for (std::size_t k = 0; k < capture.rig.cameras.size(); ++k) {
      of_capture.push_back(judge_lens(capture.rig.cameras[k].model, outlines_of(capture, k)));
    }
  }
  return lenses;
}

bool contradict(const LensesBySquares& lenses) {
  return std::any_of(lenses.begin(), lenses.end(), [](const auto& of_capture) {
    return std::any_of(of_capture.begin(), of_capture.end(),
                       [](const auto& lens) { return lens && lens->contradicts(); });
  });
}

double own_px(const LensesBySquares& lenses) {
  double sum = 0;
  double squares = 0;
  for (const auto& of_capture : lenses) {
    for (const auto& lens : of_capture) {
      if (!lens) continue;
      sum += static_cast<double>(lens->squares) * lens->best.own_px * lens->best.own_px;
      squares += static_cast<double>(lens->squares);
    }
  }
  return squares > 0 ? std::sqrt(sum / squares) : std::numeric_limits<double>::infinity();
}

std::vector<DetectedCapture> with_lenses_of_squares(std::vector<DetectedCapture> captures,
                                                    const LensesBySquares& lenses) {
  for (std::size_t c = 0; c < captures.size(); ++c) {
    for (std::size_t k = 0; k < lenses[c].size(); ++k) {
      if (!lenses[c][k] || !lenses[c][k]->contradicts()) continue;
      auto model = CameraModel::create(lenses[c][k]->best.parameters);
      if (model) captures[c].rig.cameras[k].model = *std::move(model);
    }
  }
  return captures;
}

LensEvidence lens_evidence(const DetectedCapture& capture, std::size_t place, const MonoBuild& mono,
                           const BuildOptions& options) {
  const Selection selection(mono.observations);
  const Estimate& made = mono.result.estimate;
  const Estimate& best = mono.result.evidence();
  LensEvidence evidence;
  for (std::size_t k = 0; k < capture.rig.cameras.size(); ++k) {
    auto& lens = evidence.emplace_back();
    const auto rig = mono.rig_of(place, k);
    if (!rig) continue;
    const CameraModel& stated = capture.rig.cameras[k].model;
    const CameraModel& made_by = made.calibration.rigs[*rig].cameras.front().model;
    const FitQuality by_made = fit_quality(selection, made, rig);
    const FitQuality by_best = fit_quality(selection, best, rig);
    lens = CameraLens{by_made, by_made, made_by.parameters()};
    if (by_best.joint_px < by_made.joint_px) {
      lens->fitted = by_best;
      lens->parameters = best.calibration.rigs[*rig].cameras.front().model.parameters();
    }
    if (!are_alike(stated.parameters(), made_by.parameters())) {
      lens->stated = localized_by(stated, selection, made, *rig, options);
    }
    lens->stated.own_px = lens->fitted.own_px = std::min(lens->stated.own_px, lens->fitted.own_px);
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
