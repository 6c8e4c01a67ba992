#include "mapbuilder/diagnosis/capture_causes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "mapbuilder/diagnosis/camera_alone.h"
#include "mapbuilder/diagnosis/camera_tracks.h"
#include "mapbuilder/diagnosis/fit_quality.h"
#include "mapbuilder/diagnosis/lens_causes.h"
#include "mapbuilder/diagnosis/rig_hypotheses.h"
#include "mapbuilder/diagnosis/unsynchronized.h"

namespace waymark {
namespace {

/// The mono build asks for no calibration: nothing is known of rigs in it.
BuildOptions mono_options(const BuildOptions& options) {
  BuildOptions mono = options;
  mono.refine = {};
  mono.survey = {};
  return mono;
}

Finding finding_of(const RigExplanation& explanation, const Rig& rig) {
  Finding finding;
  finding.severity = Severity::error;
  finding.cause = explanation.cause;
  for (const std::size_t k : explanation.cameras) finding.cameras.push_back(rig.cameras[k].name);
  finding.subject = fmt::format("{}", fmt::join(finding.cameras, ", "));
  finding.text = explanation.detail + ".";
  finding.remedy = explanation.remedy;
  finding.explains =
      "every image alone fits the map, and together they fit with this and not as stated";
  if (explanation.sigma > 0 || explanation.value != 0) {
    finding.figures = {{"fitted", explanation.value, explanation.unit, explanation.sigma}};
  }
  return finding;
}

/// The capture with the explanation put right, or without what it can't be put right for.
DetectedCapture put_right(const DetectedCapture& capture, const RigExplanation& explanation) {
  DetectedCapture right = capture;
  if (!explanation.leave_out) {
    for (std::size_t k = 0; k < right.rig.cameras.size(); ++k) {
      right.rig.cameras[k].rig_from_cam = explanation.rig_from_cam[k];
    }
    return right;
  }
  std::erase_if(right.images, [&](const ImageDetections& image) {
    const bool concerned =
        std::find(explanation.cameras.begin(), explanation.cameras.end(),
                  static_cast<std::size_t>(image.camera)) != explanation.cameras.end();
    return concerned &&
           (!explanation.since || image.stamp >= *explanation.since - capture.sync_tolerance);
  });
  return right;
}

bool has_a_rig(const DetectedCapture& capture) {
  return capture.rig.cameras.size() > 1 && capture.rig.has_extrinsics;
}

/// Adds a finding; of one cause there is one, which names all its cameras and captures.
void add_finding(Finding finding, std::vector<Finding>& findings) {
  for (Finding& known : findings) {
    if (known.cause != finding.cause) continue;
    for (const std::string& camera : finding.cameras) {
      if (std::find(known.cameras.begin(), known.cameras.end(), camera) == known.cameras.end()) {
        known.cameras.push_back(camera);
      }
    }
    known.captures.insert(known.captures.end(), finding.captures.begin(), finding.captures.end());
    known.subject = fmt::format("{}", fmt::join(known.cameras, ", "));
    return;
  }
  findings.push_back(std::move(finding));
}

/// A map of every image on its own.
struct MonoBuild {
  Observations observations;
  BuildResult result;
  FitQuality quality;
};

std::optional<MonoBuild> build_mono(const std::vector<DetectedCapture>& captures,
                                    const BuildOptions& options, Progress& progress) {
  auto observations = make_observations(captures, {true, options.threads});
  if (!observations) return std::nullopt;
  MonoBuild build{*std::move(observations), {}, {}};
  const Selection selection(build.observations);
  build.result = build_map(selection, mono_options(options), progress);
  build.quality = fit_quality(selection, build.result);
  return build;
}

/// A lens that only bends otherwise than stated is for a refinement to correct; one of other
/// numbers altogether is an error, however well markers' own poses hide it.
bool is_gross(const LensExplanation& why) {
  constexpr double kGrossFocal = 5.0;  // %
  return why.cause != Cause::intrinsics || (why.unit == "%" && std::abs(why.value) > kGrossFocal) ||
         why.detail.find("[cx cy fx fy]") != std::string::npos;
}

/// Asks each camera which intrinsics its images fit; those that explain it take the stated ones'
/// place.
void explain_lenses(const BuildOptions& options, ExplainedCaptures& explained) {
  constexpr double kExplains = 0.5;  // of the misfit is left at most
  for (DetectedCapture& capture : explained.captures) {
    for (std::size_t k = 0; k < capture.rig.cameras.size(); ++k) {
      RigCamera& camera = capture.rig.cameras[k];
      const auto alone = fit_camera_alone(capture, k, options);
      if (!alone) continue;
      const bool contradicts = alone->stated.contradicts();
      if (!contradicts && alone->stated.joint_px < kPoorFit_px) continue;
      if (alone->fitted.joint_px > kExplains * alone->stated.joint_px) continue;
      const auto why = explain_lens(camera.model.parameters(), alone->parameters);
      auto model = CameraModel::create(alone->parameters);
      if (!why || !model || (!contradicts && !is_gross(*why))) continue;
      camera.model = *std::move(model);
      Finding finding;
      finding.severity = Severity::error;
      finding.cause = why->cause;
      finding.subject = camera.name;
      finding.cameras = {camera.name};
      finding.captures = {capture.name};
      finding.text = fmt::format("{} (its images alone: {:.2f} px as stated, {:.2f} px so).",
                                 why->detail, alone->stated.joint_px, alone->fitted.joint_px);
      finding.remedy = why->remedy;
      finding.figures = {{"fitted", why->value, why->unit, {}}};
      add_finding(std::move(finding), explained.findings);
    }
  }
}

/// Holds where the cameras of each capture stood against its rig.
void explain_rigs(const MonoBuild& mono, ExplainedCaptures& explained) {
  for (const CaptureIndex c : mono.observations.captures.indices()) {
    DetectedCapture& capture = explained.captures[mono.observations.captures[c].place];
    if (!has_a_rig(capture)) continue;
    const CameraTracks tracks =
        tracks_of(mono.observations, mono.result, c, capture.rig, capture.sync_tolerance);
    const auto explanation = explain_rig(tracks, capture.rig);
    if (!explanation) {
      if (auto finding = leave_out_unsynchronized(tracks, capture)) {
        add_finding(*std::move(finding), explained.findings);
      }
      continue;
    }
    const Rig stated = capture.rig;
    capture = put_right(capture, *explanation);
    for (const RigExplanation& one : {*explanation, explanation->or_else()}) {
      if (one.detail.empty()) continue;
      Finding finding = finding_of(one, stated);
      finding.captures = {capture.name};
      add_finding(std::move(finding), explained.findings);
    }
  }
}

}  // namespace

ExplainedCaptures explain_captures(const std::vector<DetectedCapture>& captures, double joint_px,
                                   const BuildOptions& options, Progress& progress) {
  // Each image on its own fits so much better than all together: the lenses are not to blame.
  constexpr double kFitsAlone = 0.25;
  ExplainedCaptures explained{captures, {}};
  auto mono = build_mono(captures, options, progress);
  if (!mono) return explained;
  if (mono->quality.contradicts() || mono->quality.joint_px > kPoorFit_px) {
    explain_lenses(options, explained);
    if (!explained.findings.empty()) mono = build_mono(explained.captures, options, progress);
    if (!mono) return explained;
  }
  if (mono->quality.contradicts() && mono->quality.joint_px > kFitsAlone * joint_px) {
    return explained;
  }
  explain_rigs(*mono, explained);
  return explained;
}

}  // namespace waymark
