#include "mapbuilder/diagnosis/capture_causes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "mapbuilder/diagnosis/camera_tracks.h"
#include "mapbuilder/diagnosis/lens_evidence.h"
#include "mapbuilder/diagnosis/mono_build.h"
#include "mapbuilder/diagnosis/print_shape.h"
#include "mapbuilder/diagnosis/rig_correction.h"
#include "mapbuilder/diagnosis/rig_judge.h"
#include "mapbuilder/diagnosis/unsynchronized.h"

namespace waymark {
namespace {

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

/// Holds where the cameras of each capture stood, in a mono build of `built`, against its rig. All
/// of a capture's images at once fit to `joint_px`.
void explain_rigs(const std::vector<DetectedCapture>& built, double joint_px,
                  const BuildOptions& options, Progress& progress,
                  std::vector<LensEvidence>& lenses, ExplainedCaptures& explained) {
  // Each image on its own fits so much better than all together: the lenses are not to blame.
  constexpr double kFitsAlone = 0.25;
  const auto built_alone = build_mono(built, options, progress);
  if (!built_alone) return;
  const MonoBuild& mono = *built_alone;
  if (mono.quality.contradicts() && mono.quality.joint_px >= kFitsAlone * joint_px) return;
  for (const CaptureIndex c : mono.observations.captures.indices()) {
    const std::size_t place = mono.observations.captures[c].place;
    DetectedCapture& capture = explained.captures[place];
    if (!has_a_rig(capture)) continue;
    const CameraTracks tracks =
        tracks_of(mono.observations, mono.result, c, built[place].rig, capture.sync_tolerance);
    const auto explanation = explain_rig(tracks, capture.rig);
    if (!explanation) {
      if (auto finding = leave_out_unsynchronized(tracks, capture)) {
        add_finding(*std::move(finding), explained.findings);
      }
      continue;
    }
    // A camera that merely stands elsewhere is left to the calibration's own judgement.
    if (explanation->cause == Cause::rig_displaced) continue;
    for (const RigExplanation& one : {*explanation, explanation->or_else()}) {
      if (one.detail.empty()) continue;
      Finding finding = finding_of(one, capture.rig);
      finding.captures = {capture.name};
      add_finding(std::move(finding), explained.findings);
    }
    put_right(*explanation, capture, lenses[place]);
  }
}

/// Something is left that each image on its own does not fit either.
bool is_poor(const FitQuality& mono) {
  constexpr double kWorse = 1.4;  // than corners are worth
  return mono.joint_px > kWorse * mono.own_px || mono.joint_px > kPoorFit_px;
}

/// The lenses of every capture's cameras, judged by their own images.
std::vector<LensEvidence> lens_evidence_of(const std::vector<DetectedCapture>& captures,
                                           const BuildOptions& options) {
  std::vector<LensEvidence> lenses;
  for (const DetectedCapture& capture : captures) lenses.push_back(lens_evidence(capture, options));
  return lenses;
}

std::vector<DetectedCapture> with_fitted_lenses(std::vector<DetectedCapture> captures,
                                                const std::vector<LensEvidence>& lenses) {
  for (std::size_t c = 0; c < captures.size(); ++c) {
    captures[c] = with_fitted_lenses(std::move(captures[c]), lenses[c]);
  }
  return captures;
}

/// Of prints and lenses, the one number that all markers share is asked first: it explains where it
/// leaves nothing that lenses would have to, and no more than they leave with eight each.
bool explain_prints(const MonoBuild& as_stated, const MonoBuild& with_lenses,
                    const BuildOptions& options, ExplainedCaptures& explained) {
  const auto shape = fit_print_shape(explained.captures, options);
  constexpr double kSigmas = 5.0;
  constexpr double kAlike = 1.1;
  if (!shape || std::abs(shape->stretch) < kSigmas * shape->sigma || is_poor(shape->quality) ||
      shape->quality.joint_px > kAlike * with_lenses.quality.joint_px) {
    return false;
  }
  explained.captures = with_square_prints(std::move(explained.captures), shape->stretch);
  add_finding(finding_of(*shape, as_stated.quality), explained.findings);
  return true;
}

}  // namespace

ExplainedCaptures explain_captures(const std::vector<DetectedCapture>& captures, double joint_px,
                                   const BuildOptions& options, Progress& progress) {
  // So many of each camera's images tell lenses and prints; where cameras stood, all do.
  constexpr std::size_t kImages = 60;
  ExplainedCaptures explained{captures, {}};
  std::vector<LensEvidence> lenses(captures.size());
  std::vector<DetectedCapture> built = captures;
  const auto few = build_mono(thinned(captures, kImages), options, progress);
  if (!few) return explained;
  if (is_poor(few->quality)) {
    // Where cameras stood is told by lenses that fit their images, whatever is wrong with the
    // stated ones: exchanged cameras and turned images bend them, too.
    lenses = lens_evidence_of(captures, options);
    built = with_fitted_lenses(captures, lenses);
    const auto fitted = build_mono(thinned(built, kImages), options, progress);
    if (!fitted) return explained;
    if (explain_prints(*few, *fitted, options, explained)) {
      lenses.assign(captures.size(), {});
      built = explained.captures;
    }
  }
  if (std::any_of(captures.begin(), captures.end(), has_a_rig)) {
    explain_rigs(built, joint_px, options, progress, lenses, explained);
  }
  for (std::size_t c = 0; c < captures.size(); ++c) {
    for (Finding& finding : correct_lenses(lenses[c], explained.captures[c])) {
      add_finding(std::move(finding), explained.findings);
    }
  }
  return explained;
}

}  // namespace waymark
