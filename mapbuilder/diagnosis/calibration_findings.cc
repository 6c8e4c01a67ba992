#include "mapbuilder/diagnosis/calibration_findings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>

namespace waymark {
namespace {

constexpr double kDegreesPerRadian = 57.29577951308232;

Finding refusal(const BuiltSubMap& submap) {
  Finding finding;
  finding.kind = FindingKind::refinement_refused;
  finding.title = "The refinement was refused; the map stands as without it";
  finding.evidence = fmt::format("{}.", fmt::join(submap.calibration->refused, "; "));
  finding.remedy =
      "Record more views: several markers in each, from many sides and distances, with turns about "
      "all axes; for the scale, measure a distance.";
  return finding;
}

Finding partial_refusal(const BuiltSubMap& submap) {
  Finding finding;
  finding.kind = FindingKind::refinement_refused;
  finding.title = "A part of the refinement was refused and stays as stated";
  finding.evidence = fmt::format("{}.", fmt::join(submap.calibration->held, "; "));
  finding.remedy =
      "Record more views that several cameras share, from many sides and distances, with turns "
      "about "
      "all axes.";
  return finding;
}

/// How far a survey entry may be off its stated sigma before it is named.
constexpr double kSurveySigmas = 5.0;

/// Bars of what is worth naming: less is within what any rig file leaves.
constexpr double kSigmas = 5.0;
constexpr double kWorthNaming_m = 0.002;
constexpr double kWorthNaming_rad = 0.1 / kDegreesPerRadian;
constexpr double kWorthNamingFocal = 0.002;

Finding rig_misfit(const RigCamera& before, const RigCamera& after, const CameraUncertainty& sure) {
  const double moved_m = (after.rig_from_cam.translation - before.rig_from_cam.translation).norm();
  const double turned_rad =
      angle_between_rad(after.rig_from_cam.rotation, before.rig_from_cam.rotation);
  Finding finding;
  finding.kind = FindingKind::rig_misfit;
  finding.title = fmt::format("The rig file does not fit {}", before.name);
  finding.evidence = fmt::format(
      "The images put it {:.1f} mm (± {:.1f}) and {:.2f}° (± {:.2f}) away from where rig.yaml has "
      "it.",
      1e3 * moved_m, 1e3 * sure.position_m, kDegreesPerRadian * turned_rad,
      kDegreesPerRadian * sure.rotation_rad);
  finding.remedy = "Calibrate the rig anew, or build with --refine extrinsics.";
  finding.cameras = {before.name};
  finding.figures = {
      {"moved", moved_m, "m", sure.position_m},
      {"turned", kDegreesPerRadian * turned_rad, "°", kDegreesPerRadian * sure.rotation_rad}};
  return finding;
}

Finding intrinsics_misfit(const RigCamera& before, const RigCamera& after,
                          const CameraUncertainty& sure, double lens_px) {
  const CameraParameters& old_one = before.model.parameters();
  const CameraParameters& new_one = after.model.parameters();
  const double focal = new_one.fu_px / old_one.fu_px - 1.0;
  const bool stated_straight =
      old_one.distortion == Distortion::none ||
      (old_one.distortion == Distortion::radtan && old_one.coefficients == std::array<double, 4>{});
  Finding finding;
  finding.kind = FindingKind::intrinsics_misfit;
  finding.title = fmt::format("The intrinsics of {} do not fit its images", before.name);
  finding.evidence = fmt::format(
      "Its focal length fits {:+.2f} % (± {:.2f}) off the stated one, and its lens bends the image "
      "up "
      "to {:.1f} px otherwise than stated{}.",
      100 * focal, 100 * sure.focal, lens_px,
      stated_straight ? ": the stated zero distortion is wrong" : "");
  finding.remedy = "Calibrate the camera anew, or build with --refine intrinsics.";
  finding.cameras = {before.name};
  finding.figures = {{"focal length", 100 * focal, "%", 100 * sure.focal},
                     {"largest shift", lens_px, "px", {}}};
  return finding;
}

/// Largest difference of two camera models over the image, with what a turn of the camera could
/// take up left in (px): where bearings of the old one land in the new one.
double largest_shift_px(const CameraModel& before, const CameraModel& after) {
  constexpr int kSteps = 8;
  const CameraParameters& p = before.parameters();
  double largest = 0;
  for (int row = 0; row <= kSteps; ++row) {
    for (int column = 0; column <= kSteps; ++column) {
      const Eigen::Vector2d pixel(p.width_px * static_cast<double>(column) / kSteps,
                                  p.height_px * static_cast<double>(row) / kSteps);
      const auto bearing = before.bearing(pixel);
      if (!bearing) continue;
      const auto there = after.project(*bearing);
      if (there) largest = std::max(largest, (*there - pixel).norm());
    }
  }
  return largest;
}

void name_misfits(const CalibrationResult& calibration, std::vector<Finding>& findings) {
  const bool judge_extrinsics =
      calibration.applied || calibration.extrinsics_cost_ratio < kExplainsTooLittle;
  const bool judge_intrinsics =
      calibration.applied || calibration.intrinsics_cost_ratio < kExplainsTooLittle;
  if (calibration.rigs_fitted.empty()) return;
  const std::vector<Rig>& after = calibration.rigs_fitted;
  std::size_t index = 0;
  for (std::size_t r = 0; r < after.size(); ++r) {
    for (std::size_t c = 0; c < after[r].cameras.size(); ++c, ++index) {
      const RigCamera& stated = calibration.rigs_before[r].cameras[c];
      const RigCamera& fitted = after[r].cameras[c];
      const CameraUncertainty& sure = calibration.uncertainty.cameras[index];
      const double moved_m =
          (fitted.rig_from_cam.translation - stated.rig_from_cam.translation).norm();
      const double turned_rad =
          angle_between_rad(fitted.rig_from_cam.rotation, stated.rig_from_cam.rotation);
      if (judge_extrinsics &&
          (moved_m > std::max(kWorthNaming_m, kSigmas * sure.position_m) ||
           turned_rad > std::max(kWorthNaming_rad, kSigmas * sure.rotation_rad))) {
        findings.push_back(rig_misfit(stated, fitted, sure));
      }
      if (!judge_intrinsics || stated.model.parameters() == fitted.model.parameters()) continue;
      constexpr double kWorthNaming_px = 1.0;
      const double shift_px = largest_shift_px(stated.model, fitted.model);
      const double focal =
          std::abs(fitted.model.parameters().fu_px / stated.model.parameters().fu_px - 1.0);
      if (focal > std::max(kWorthNamingFocal, kSigmas * sure.focal) || shift_px > kWorthNaming_px) {
        findings.push_back(intrinsics_misfit(stated, fitted, sure, shift_px));
      }
    }
  }
}

void name_survey(const BuiltSubMap& submap, std::vector<Finding>& findings) {
  for (const SurveyResidual& entry : submap.survey) {
    if (!entry.mapped || std::abs(entry.residual_m) <= kSurveySigmas * entry.sigma_m) continue;
    Finding finding;
    finding.kind = FindingKind::survey_disagrees;
    finding.title = fmt::format("The survey's {} disagrees with the map", entry.entry);
    finding.evidence = fmt::format("Off by {:.1f} mm, {:.1f} times its stated sigma of {:.1f} mm.",
                                   1e3 * entry.residual_m,
                                   std::abs(entry.residual_m) / entry.sigma_m, 1e3 * entry.sigma_m);
    finding.remedy = "Measure it again; if it stands, look at sizes and calibration.";
    finding.figures = {{"residual", entry.residual_m, "m", entry.sigma_m}};
    findings.push_back(finding);
  }
}

}  // namespace

std::vector<Finding> calibration_findings(const BuildResult& result, const BuildOptions& options) {
  std::vector<Finding> findings;
  for (std::size_t i = 0; i < result.submaps.size(); ++i) {
    const BuiltSubMap& submap = result.submaps[i];
    const std::size_t first = findings.size();
    if (submap.calibration) {
      if (!submap.calibration->refused.empty()) {
        findings.push_back(refusal(submap));
      } else {
        if (!submap.calibration->held.empty()) findings.push_back(partial_refusal(submap));
        name_misfits(*submap.calibration, findings);
      }
    }
    name_survey(submap, findings);
    for (std::size_t f = first; f < findings.size(); ++f) findings[f].submap = i;
  }
  if (!options.survey.empty() && !result.submaps.empty()) {
    const SubMap& map = result.submaps.front().map;
    if (map.frame != FrameKind::facility && !options.survey.points.empty()) {
      Finding finding;
      finding.kind = FindingKind::survey_undetermined;
      finding.title = "The survey's points do not fix the facility frame";
      finding.evidence =
          "It takes at least 3 points for fit, not on a line, on at least 2 mapped markers.";
      finding.remedy = "Measure more points, or points on markers that are mapped.";
      findings.push_back(finding);
    }
  }
  return findings;
}

}  // namespace waymark
