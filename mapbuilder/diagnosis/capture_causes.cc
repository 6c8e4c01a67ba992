#include "mapbuilder/diagnosis/capture_causes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "mapbuilder/diagnosis/camera_tracks.h"
#include "mapbuilder/diagnosis/fit_quality.h"
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

class CaptureExplainer {
 public:
  CaptureExplainer(const std::vector<DetectedCapture>& captures, const LensesBySquares& lenses,
                   const StatedBuild* build, const BuildOptions& options)
      : captures_(captures),
        few_(telling_images(captures)),
        lenses_(lenses),
        stated_(build),
        options_(options),
        evidence_(captures.size()) {
    explained_.captures = captures;
  }

  ExplainedCaptures explain() && {
    const bool contradicted = contradict(lenses_);
    if (!contradicted) take_mono();
    if ((contradicted || is_poor(quality_)) && !explain_prints()) {
      if (contradicted) take_mono(with_lenses_of_squares(captures_, lenses_));
      take_lenses();
    }
    if (mono_) explain_rigs();
    for (std::size_t c = 0; c < captures_.size(); ++c) {
      for (Finding& finding : correct_lenses(evidence_[c], explained_.captures[c])) {
        add_finding(std::move(finding), explained_.findings);
      }
    }
    return std::move(explained_);
  }

 private:
  /// Every image of the captures as stated on its own; where no rig joins images, the build as
  /// stated is that.
  void take_mono() {
    const bool joined = std::any_of(captures_.begin(), captures_.end(), has_a_rig);
    if (stated_ == nullptr || joined) return take_mono(captures_);
    built_ = captures_;
    mono_ = MonoBuild{stated_->observations, stated_->result};
    judge_mono();
  }

  void take_mono(std::vector<DetectedCapture> captures) {
    built_ = std::move(captures);
    mono_ = build_mono(telling_images(built_), options_);
    judge_mono();
  }

  void judge_mono() {
    quality_ =
        mono_ ? fit_quality(Selection(mono_->observations), mono_->result.estimate) : FitQuality{};
  }

  /// Of prints and lenses, the one number that all markers share is asked first: it explains where
  /// it leaves nothing that lenses would have to, and about as much as they leave with eight each,
  /// which follow the noise by a tenth of it.
  bool explain_prints() {
    constexpr double kAlike = 1.2;
    const auto shape = fit_print_shape(few_);
    if (!shape || shape->own_px > kAlike * own_px(lenses_) ||
        contradict(judge_lenses(with_square_prints(few_, shape->stretch)))) {
      return false;
    }
    auto square = with_square_prints(captures_, shape->stretch);
    auto mono = build_mono(telling_images(square), options_);
    if (!mono) return false;
    const FitQuality quality = fit_quality(Selection(mono->observations), mono->result.estimate);
    if (is_poor(quality)) return false;
    add_finding(finding_of(*shape, quality, stated_own_px()), explained_.findings);
    mono_ = std::move(mono);
    quality_ = quality;
    built_ = square;
    explained_.captures = std::move(square);
    return true;
  }

  /// What corners are worth by the stated lenses.
  [[nodiscard]] double stated_own_px() const {
    double worst = 0;
    for (const auto& of_capture : lenses_) {
      for (const auto& lens : of_capture) {
        if (lens) worst = std::max(worst, lens->stated_px);
      }
    }
    return worst;
  }

  /// Where cameras stood is told by lenses that fit their images, whatever is wrong with the stated
  /// ones: exchanged cameras and turned images bend them, too.
  void take_lenses() {
    if (!mono_) return;
    for (std::size_t c = 0; c < captures_.size(); ++c) {
      evidence_[c] = lens_evidence(captures_[c], c, *mono_, options_);
      for (std::size_t k = 0; k < evidence_[c].size(); ++k) {
        if (evidence_[c][k]) improve_lens(captures_[c], k, *evidence_[c][k]);
      }
      built_[c] = with_fitted_lenses(captures_[c], evidence_[c]);
    }
    if (std::any_of(captures_.begin(), captures_.end(), has_a_rig)) take_mono(built_);
  }

  /// A lens that is far from the stated one is not found among sound ones, in whose noise its own
  /// misfit is lost: its camera's images alone refine what it has come to so far, and where that
  /// leads nowhere, lenses of other focal lengths. One that fits its own images as stated was only
  /// bent by others'.
  void improve_lens(const DetectedCapture& capture, std::size_t camera, CameraLens& lens) const {
    if (!lens.misfits() && !is_poor(lens.fitted)) return;
    DetectedCapture alone = capture;
    std::erase_if(alone.images, [&](const ImageDetections& image) {
      return image.camera != static_cast<int>(camera);
    });
    alone = telling_images({std::move(alone)}).front();
    if (capture.rig.cameras.size() > 1 && is_acquitted(alone, lens)) return;
    refine_lens(alone, camera, lens.parameters, lens);
    const CameraParameters stated = capture.rig.cameras[camera].model.parameters();
    for (const double factor : {0.8, 1.25, 0.65, 1.5}) {
      if (!is_poor(lens.fitted)) return;
      CameraParameters start = stated;
      start.fu_px *= factor;
      start.fv_px *= factor;
      refine_lens(alone, camera, start, lens);
    }
  }

  /// Whether a camera's images alone fit the stated lens; then `lens` says so.
  bool is_acquitted(const DetectedCapture& alone, CameraLens& lens) const {
    const auto mono = build_mono({alone}, options_);
    if (!mono) return false;
    const FitQuality quality = fit_quality(Selection(mono->observations), mono->result.estimate);
    if (is_poor(quality)) return false;
    lens.stated = quality;
    return true;
  }

  /// Takes the lens that a camera's images refine `start` to, where they fit that better.
  void refine_lens(DetectedCapture alone, std::size_t camera, CameraParameters start,
                   CameraLens& lens) const {
    auto model = CameraModel::create(start);
    if (!model) return;
    alone.rig.cameras[camera].model = *std::move(model);
    const auto mono = build_mono({alone}, options_, MonoLenses::refined);
    if (!mono) return;
    const auto refined = lens_evidence(alone, 0, *mono, options_)[camera];
    if (!refined || refined->fitted.joint_px > lens.fitted.joint_px) return;
    lens.fitted = refined->fitted;
    lens.parameters = refined->parameters;
  }

  /// Holds where the cameras of each capture stood against its rig.
  void explain_rigs() {
    // Each image on its own fits so much better than all together: the lenses are not to blame.
    constexpr double kFitsAlone = 0.25;
    if (quality_.contradicts() &&
        (stated_ == nullptr || quality_.joint_px >= kFitsAlone * stated_->joint_px)) {
      return;
    }
    for (std::size_t c = 0; c < captures_.size(); ++c) {
      if (has_a_rig(captures_[c])) explain_rig_of(c);
    }
  }

  void explain_rig_of(std::size_t place) {
    DetectedCapture& capture = explained_.captures[place];
    const auto localized = localize_images(built_[place], *mono_, options_);
    if (!localized) return;
    const CameraTracks tracks = tracks_of(*localized, built_[place].rig, capture.sync_tolerance);
    const auto explanation = explain_rig(tracks, capture.rig);
    if (!explanation) {
      if (auto finding = leave_out_unsynchronized(tracks, capture)) {
        add_finding(*std::move(finding), explained_.findings);
      }
      return;
    }
    if (explanation->cause == Cause::rig_displaced) {
      take_displaced(place, *explanation);
      return;
    }
    Finding finding = finding_of(*explanation, capture.rig);
    finding.captures = {capture.name};
    add_finding(std::move(finding), explained_.findings);
    put_right(*explanation, capture, evidence_[place]);
  }

  void take_displaced(std::size_t place, const RigExplanation& explanation) {
    const DetectedCapture& capture = explained_.captures[place];
    Finding finding = finding_of(explanation, capture.rig);
    finding.captures = {capture.name};
    explained_.displaced.push_back({place, capture.rig, std::move(finding)});
    Rig& rig = explained_.displaced.back().rig;
    for (std::size_t k = 0; k < rig.cameras.size(); ++k) {
      rig.cameras[k].rig_from_cam = explanation.rig_from_cam[k];
    }
  }

  const std::vector<DetectedCapture>& captures_;
  const std::vector<DetectedCapture> few_;
  const LensesBySquares& lenses_;
  const StatedBuild* stated_;
  const BuildOptions& options_;
  std::vector<LensEvidence> evidence_;
  std::vector<DetectedCapture> built_;  ///< what mono_ was made of
  std::optional<MonoBuild> mono_;
  FitQuality quality_;  ///< of mono_, once lenses are taken of its examination
  ExplainedCaptures explained_;
};

}  // namespace

ExplainedCaptures explain_captures(const std::vector<DetectedCapture>& captures,
                                   const LensesBySquares& lenses, const StatedBuild* build,
                                   const BuildOptions& options) {
  return CaptureExplainer(captures, lenses, build, options).explain();
}

}  // namespace waymark
