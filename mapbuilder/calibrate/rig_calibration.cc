#include "mapbuilder/calibrate/rig_calibration.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "mapbuilder/calibrate/calibrated_cameras.h"
#include "mapbuilder/calibrate/posterior_sigmas.h"
#include "mapbuilder/diagnosis/diagnosed_build.h"

namespace waymark {
namespace {

/// A number that is less sure is not determined. Sigmas go with the rig file, so that these need
/// not be what a vehicle drives by.
RefinementLimits calibration_limits() {
  RefinementLimits limits;
  limits.position_m = 0.01;
  limits.rotation_rad = 0.0087;  // 0.5°
  limits.focal = 0.01;
  return limits;
}

/// Of eight residuals together: a lens must not follow what tells merely where a rig is, such as
/// corners that are half covered. (8: the end of Gaussian noise, to 20: a build's own)
constexpr double kGate_sigmas = 8.0;

/// A map with lenses and places refined in it.
struct RefinedMap {
  Observations observations;
  BuildResult result;
  FitQuality quality;
};

class RigCalibrator {
 public:
  RigCalibrator(std::vector<DetectedCapture> captures, const FoundRig& found,
                const RigCalibrationOptions& options, Progress& progress)
      : captures_(std::move(captures)), options_(options), progress_(progress), rig_(found.rig) {
    calibration_.findings = found.findings;
  }

  Expected<RigCalibration> calibrate() {
    if (auto refined = refine_jointly(); !refined) return tl::make_unexpected(refined.error());
    take_sigmas();
    test_by_halves();
    take_coverage();
    say_what_is_missing();
    return std::move(calibration_);
  }

 private:
  [[nodiscard]] bool linked() const { return rig_.cameras.size() < 2 || rig_.has_extrinsics; }

  [[nodiscard]] BuildOptions refining() const {
    BuildOptions build = options_.build;
    build.refine = {};
    build.refine.intrinsics = true;
    build.refine.straight_lenses_bend = false;
    build.refine.extrinsics = linked() && rig_.cameras.size() > 1;
    build.survey = {};
    build.refinement_limits = calibration_limits();
    build.gate.reject_sigmas = std::min(build.gate.reject_sigmas, kGate_sigmas);
    return build;
  }

  Expected<RefinedMap> refined_map(const std::vector<DetectedCapture>& captures) {
    auto observations =
        make_observations(with_rig(captures, rig_), {!linked(), options_.build.threads});
    if (!observations) return tl::make_unexpected(observations.error());
    RefinedMap map{*std::move(observations), {}, {}};
    map.result = build_map(Selection(map.observations), refining(), progress_);
    map.quality = fit_quality(Selection(map.observations), map.result.estimate);
    if (map.result.calibration.refined) return map;
    const auto& refused = map.result.calibration.refused;
    return fail(Cause::few_views,
                "rig: the images do not tell it: {}; record more views: several markers in each, "
                "from many sides and distances, with turns about all axes",
                refused.empty() ? "no two markers are seen together"
                                : fmt::format("{}", fmt::join(refused, "; ")));
  }

  /// What was grown with a rig that is off lacks images and markers: again with the refined one,
  /// until nothing is won; then without markers that are wrong.
  Status refine_jointly() {
    constexpr int kMostRounds = 4;
    constexpr double kWorthAnother = 0.99;
    std::optional<RefinedMap> best;
    for (int round = 0; round < kMostRounds; ++round) {
      auto next = refined_map(captures_);
      if (!next && !best) return tl::make_unexpected(next.error());
      if (!next) break;
      const bool goes_on = !best || next->quality.joint_px < kWorthAnother * best->quality.joint_px;
      take_rig_of(next->result);
      best = *std::move(next);
      if (!goes_on) break;
    }
    DiagnosedBuild diagnosed =
        build_and_diagnose(best->observations, refining(), {}, progress_, std::move(best->result));
    if (diagnosed.result.calibration.refined) take_rig_of(diagnosed.result);
    for (Finding& finding : diagnosed.findings) {
      calibration_.findings.push_back(std::move(finding));
    }
    calibration_.observations = std::move(best->observations);
    calibration_.result = std::move(diagnosed.result);
    calibration_.quality =
        fit_quality(Selection(calibration_.observations), calibration_.result.estimate);
    return {};
  }

  void take_rig_of(const BuildResult& result) { rig_ = rig_of(result); }

  /// The rig's cameras as a map has them, be they one rig there or, without places, a rig each.
  [[nodiscard]] Rig rig_of(const BuildResult& result) const {
    const auto& rigs = result.estimate.calibration.rigs;
    Rig rig = rig_;
    for (std::size_t k = 0; k < rig.cameras.size(); ++k) {
      if (linked()) {
        rig.cameras[k].model = rigs[RigIndex(0)].cameras[k].model;
        rig.cameras[k].rig_from_cam = rigs[RigIndex(0)].cameras[k].rig_from_cam;
      } else {
        rig.cameras[k].model = rigs[RigIndex(k)].cameras.front().model;
      }
    }
    return rig;
  }

  [[nodiscard]] Rig rig_with_sigmas(const BuildResult& result) const {
    const CalibrationResult& found = result.calibration;
    return with_posterior_sigmas(rig_of(result), found.uncertainty.joint,
                                 !found.left_as_stated.empty(), calibration_limits());
  }

  void take_sigmas() { calibration_.rig = rig_with_sigmas(calibration_.result); }

  /// What all images of a round have in common that no model knows is no noise of theirs: the
  /// posterior can't see it, but two parts of the round can.
  void test_by_halves() {
    std::vector<Rig> rigs;
    for (const auto& half : halves_of(captures_)) {
      const auto map = refined_map(half);
      if (!map || map->observations.rigs.size() != calibration_.observations.rigs.size()) return;
      rigs.push_back(rig_with_sigmas(map->result));
    }
    const double apart = std::sqrt(squared_sigmas_apart(rigs[0], rigs[1]));
    calibration_.halves_apart = apart;
    if (apart > 1) calibration_.rig = with_sigmas_times(std::move(calibration_.rig), apart);
  }

  void take_coverage() {
    std::map<CameraIndex, std::vector<Eigen::Vector2d>> seen;
    for (const BuiltSubMap& submap : calibration_.result.submaps) {
      for (const ObservationResidual& residual : submap.residuals) {
        if (!residual.accepted) continue;
        const Observation& o = calibration_.observations[residual.observation];
        auto& corners = seen[o.camera];
        corners.insert(corners.end(), o.corners_px.begin(), o.corners_px.end());
      }
    }
    // Cameras are numbered through, be they one rig or a rig each.
    for (std::size_t k = 0; k < rig_.cameras.size(); ++k) {
      calibration_.coverage.push_back(
          image_coverage(rig_.cameras[k].name, rig_.cameras[k].model, seen[CameraIndex(k)]));
    }
  }

  void say_what_is_missing() {
    for (const ImageCoverage& coverage : calibration_.coverage) {
      for (Finding& finding : findings_of(coverage)) {
        calibration_.findings.push_back(std::move(finding));
      }
    }
    const CalibrationResult& found = calibration_.result.calibration;
    if (!found.left_as_stated.empty()) say_what_is_held(found.left_as_stated);
    if (calibration_.quality.contradicts()) say_that_it_does_not_fit();
    if (rig_.cameras.size() == 1) say_that_it_is_alone();
  }

  void say_what_is_held(const std::vector<std::string>& held) {
    Finding finding;
    finding.cause = Cause::few_views;
    finding.subject = "rig";
    finding.text = fmt::format(
        "a part could not be told and is held where it began, with sigmas that say so: {}.",
        fmt::join(held, "; "));
    finding.remedy =
        "Record more views: several markers in each, from many sides and distances, with turns "
        "about all axes.";
    calibration_.findings.push_back(std::move(finding));
  }

  void say_that_it_does_not_fit() {
    const FitQuality& quality = calibration_.quality;
    Finding finding;
    finding.severity = Severity::error;
    finding.cause = Cause::map_misfit;
    finding.subject = "rig";
    finding.text = fmt::format(
        "no rig fits these images: the worst camera misses by {} where each marker alone fits to "
        "{:.2f} px.",
        worst_camera_text(quality), quality.own_px);
    finding.remedy =
        "Check stamps (one clock for all cameras), sizes and ids in markers.toml, and that no "
        "camera moved on the rig; calibrate each camera alone.";
    calibration_.findings.push_back(std::move(finding));
  }

  void say_that_it_is_alone() {
    Finding finding;
    finding.severity = Severity::note;
    finding.cause = Cause::few_views;
    finding.subject = rig_.cameras.front().name;
    finding.text = "the only camera: it has no extrinsics, its frame is the rig's.";
    calibration_.findings.push_back(std::move(finding));
  }

  std::vector<DetectedCapture> captures_;
  const RigCalibrationOptions& options_;
  Progress& progress_;
  Rig rig_;
  RigCalibration calibration_;
};

}  // namespace

Expected<RigCalibration> calibrate_rig(std::vector<DetectedCapture> captures, const FoundRig& found,
                                       const RigCalibrationOptions& options, Progress& progress) {
  auto of_one_rig = with_common_rig(std::move(captures));
  if (!of_one_rig) return tl::make_unexpected(of_one_rig.error());
  return RigCalibrator(*std::move(of_one_rig), found, options, progress).calibrate();
}

std::optional<FitQuality> fit_of_rig(const std::vector<DetectedCapture>& captures, const Rig& rig,
                                     const BuildOptions& options, Progress& progress) {
  const bool mono = rig.cameras.size() > 1 && !rig.has_extrinsics;
  const auto observations = make_observations(with_rig(captures, rig), {mono, options.threads});
  if (!observations) return std::nullopt;
  const Selection selection(*observations);
  const BuildResult result = build_map(selection, options, progress);
  if (result.submaps.empty()) return std::nullopt;
  return fit_quality(selection, result.estimate);
}

}  // namespace waymark
