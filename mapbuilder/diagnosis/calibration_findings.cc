#include "mapbuilder/diagnosis/calibration_findings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "core/camera/lens_kind.h"
#include "core/geometry/degrees.h"
#include "core/geometry/symmetric_factor.h"
#include "mapbuilder/bundle/constant_direction.h"
#include "mapbuilder/diagnosis/baseline_scale.h"
#include "mapbuilder/diagnosis/camera_displacement.h"

namespace waymark {
namespace {

Finding refusal(const CalibrationResult& calibration) {
  Finding finding;
  finding.cause = Cause::few_views;
  finding.subject = "--refine";
  finding.text = fmt::format("The refinement was refused; the map stands as without it: {}.",
                             fmt::join(calibration.refused, "; "));
  finding.remedy =
      "Record more views: several markers in each, from many sides and distances, with turns about "
      "all axes; for the scale, measure a distance.";
  return finding;
}

Finding partial_refusal(const CalibrationResult& calibration) {
  Finding finding;
  finding.cause = Cause::few_views;
  finding.subject = "--refine";
  finding.text = fmt::format("A part of the refinement was refused and stays as stated: {}.",
                             fmt::join(calibration.left_as_stated, "; "));
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
constexpr double kWorthNamingFocal = 0.002;

constexpr const char* kRefinedRemedy =
    "The map is built with what the images say; use the refined rig from now on.";

Finding rig_misfit(const std::string& camera, const CameraDisplacement& off, bool refined) {
  Finding finding;
  finding.cause = Cause::rig_displaced;
  finding.subject = camera;
  finding.text = fmt::format("the images put it {} and {} away from where rig.yaml has it.",
                             give_or_take(1e3 * off.moved_m, 1e3 * off.moved_sigma_m, " mm", 1),
                             give_or_take(kDegreesPerRadian * off.turned_rad,
                                          kDegreesPerRadian * off.turned_sigma_rad, "°", 2));
  finding.remedy =
      refined ? kRefinedRemedy : "Calibrate the rig anew, or build with --refine extrinsics.";
  finding.cameras = {camera};
  finding.figures = {{"moved", off.moved_m, "m", off.moved_sigma_m},
                     {"turned", kDegreesPerRadian * off.turned_rad, "°",
                      kDegreesPerRadian * off.turned_sigma_rad}};
  return finding;
}

Finding intrinsics_misfit(const RigCamera& before, const RigCamera& after,
                          const CameraUncertainty& sure, double lens_px, bool refined) {
  const CameraParameters& old_one = before.model.parameters();
  const CameraParameters& new_one = after.model.parameters();
  const double focal = new_one.fu_px / old_one.fu_px - 1.0;
  const bool stated_straight = is_straight(old_one);
  Finding finding;
  finding.cause = Cause::intrinsics;
  finding.subject = before.name;
  finding.text = fmt::format(
      "images fit a focal length {} off the stated one, and a lens that puts its markers up to "
      "{:.1f} px elsewhere than the stated one{}.",
      give_or_take(100 * focal, 100 * sure.focal, " %", 2), lens_px,
      stated_straight ? ": the stated zero distortion is wrong" : "");
  finding.remedy =
      refined ? kRefinedRemedy : "Calibrate the camera anew, or build with --refine intrinsics.";
  finding.cameras = {before.name};
  finding.figures = {{"focal length", 100 * focal, "%", 100 * sure.focal},
                     {"largest shift", lens_px, "px", {}}};
  return finding;
}

/// Whether what was fitted differs from the stated intrinsics by more than chance: the squared
/// Mahalanobis distance, a freedom per number. False where nothing is determined.
bool differ_surely(const CameraModel& stated, const CameraModel& fitted,
                   const CalibrationUncertainty& sure, CameraIndex camera) {
  if (sure.joint.size() == 0) return false;
  const auto first =
      static_cast<Eigen::Index>(6 * sure.cameras.size() + kIntrinsicNumbers * camera.value());
  using Covariance = Eigen::Matrix<double, kIntrinsicNumbers, kIntrinsicNumbers>;
  const Covariance covariance =
      sure.joint.block<kIntrinsicNumbers, kIntrinsicNumbers>(first, first);
  // Per sigma, for focal lengths and lens coefficients are of different size. What was not free
  // (the lens of a camera stated without any, at first) differs by nothing.
  const IntrinsicsVector sigma = covariance.diagonal().cwiseSqrt();
  if (!(sigma.maxCoeff() > 0)) return false;
  const IntrinsicsVector per_sigma =
      sigma.unaryExpr([](double one) { return one > 0 ? 1.0 / one : 0.0; });
  const IntrinsicsVector off = per_sigma.cwiseProduct(intrinsics_of(fitted.parameters()) -
                                                      intrinsics_of(stated.parameters()));
  Covariance correlation = per_sigma.asDiagonal() * covariance * per_sigma.asDiagonal();
  for (Eigen::Index i = 0; i < kIntrinsicNumbers; ++i) {
    if (!(sigma[i] > 0)) correlation(i, i) = 1.0;
  }
  const double distance2 = off.dot(SymmetricFactor<kIntrinsicNumbers>(correlation).solve(off));
  // As unlikely as five sigmas of one freedom: 44 with eight freedoms, two for each one more.
  const auto freedoms = static_cast<double>((sigma.array() > 0).count());
  return distance2 > 44.0 + 2.0 * std::max(0.0, freedoms - 8.0);
}

/// Corners of the observations that the map rests on, by camera: where in the image something was
/// seen.
using SeenCorners = std::map<CameraIndex, std::vector<Eigen::Vector2d>>;

SeenCorners seen_corners(const BuildResult& result, const Observations& observations) {
  SeenCorners seen;
  for (const BuiltSubMap& submap : result.submaps) {
    for (const ObservationResidual& residual : submap.residuals) {
      if (!residual.accepted) continue;
      const Observation& o = observations[residual.observation];
      auto& corners = seen[o.camera];
      corners.insert(corners.end(), o.corners_px.begin(), o.corners_px.end());
    }
  }
  return seen;
}

/// Largest difference of two camera models, in px, where markers were seen: elsewhere a fitted lens
/// says nothing.
double largest_shift_px(const CameraModel& before, const CameraModel& after,
                        const std::vector<Eigen::Vector2d>& pixels) {
  double largest = 0;
  for (const Eigen::Vector2d& pixel : pixels) {
    const auto bearing = before.bearing(pixel);
    if (!bearing) continue;
    const auto there = after.project(*bearing);
    if (there) largest = std::max(largest, (*there - pixel).norm());
  }
  return largest;
}

/// Of the fitted rig_from_cam of the rig whose first camera has this number, six per camera;
/// nullopt: nothing is determined.
std::optional<Eigen::MatrixXd> covariance_of_places(const CalibrationResult& calibration,
                                                    RigIndex rig, std::size_t first) {
  const auto at = static_cast<Eigen::Index>(6 * first);
  const auto size = static_cast<Eigen::Index>(6 * calibration.rigs_before[rig].cameras.size());
  const Eigen::MatrixXd& joint = calibration.uncertainty.joint;
  if (joint.rows() < at + size) return std::nullopt;
  return joint.block(at, at, size, size);
}

std::vector<CameraDisplacement> displacements_of(const Rig& stated, const Rig& fitted,
                                                 const Eigen::MatrixXd& covariance) {
  return camera_displacements(stated, fitted, covariance,
                              least_displacing_reference(stated, fitted, covariance));
}

/// One factor on all baselines, where that is clear, or where cameras would be named else: one
/// number comes before many. Of two cameras it is no less than the other's place.
std::optional<BaselineScale> scale_of(const Rig& stated, const Rig& fitted,
                                      const Eigen::MatrixXd& covariance) {
  constexpr double kGainOverCameras = 4.0;
  if (auto clear = baseline_scale(stated, fitted, covariance)) return clear;
  const auto displaced = displacements_of(stated, fitted, covariance);
  const bool names_some = std::any_of(displaced.begin(), displaced.end(),
                                      [](const auto& one) { return one.is_worth_naming(); });
  if (!names_some || displaced.size() < 3) return std::nullopt;
  return baseline_scale(stated, fitted, covariance, kGainOverCameras);
}

/// One factor on all baselines is the sizes' fault as likely as the cameras'; what is left is some
/// camera's.
void name_displaced(const CalibrationResult& calibration, RigIndex rig, std::size_t first,
                    bool refined, std::vector<Finding>& findings) {
  const auto covariance = covariance_of_places(calibration, rig, first);
  if (!covariance) return;
  Rig stated = calibration.rigs_before[rig];
  const Rig& fitted = calibration.rigs_fitted[rig];
  if (const auto scale = scale_of(stated, fitted, *covariance)) {
    findings.push_back(finding_of(*scale, stated));
    stated = with_baselines(std::move(stated), scale->factor);
  }
  const auto displaced = displacements_of(stated, fitted, *covariance);
  for (std::size_t c = 0; c < displaced.size(); ++c) {
    if (!displaced[c].is_worth_naming()) continue;
    findings.push_back(rig_misfit(stated.cameras[c].name, displaced[c], refined));
  }
}

void name_misfits(const CalibrationResult& calibration, const VariableCalibration& asked,
                  const SeenCorners& seen, std::vector<Finding>& findings) {
  // Refined sizes alone leave the rig file as it is: then what was fitted to it is evidence only.
  const bool rig_refined = calibration.refined && (asked.extrinsics || asked.intrinsics);
  const bool judge_extrinsics =
      rig_refined || calibration.extrinsics_cost_ratio < kExplainsTooLittle;
  const bool judge_intrinsics =
      rig_refined || calibration.intrinsics_cost_ratio < kExplainsTooLittle;
  // Without two markers in any frame set nothing was adjusted, and nothing is known.
  if (calibration.rigs_fitted.empty() || calibration.uncertainty.cameras.empty()) return;
  const IndexedVector<RigIndex, Rig>& after = calibration.rigs_fitted;
  std::size_t count = 0;
  for (const RigIndex r : after.indices()) {
    if (judge_extrinsics) name_displaced(calibration, r, count, rig_refined, findings);
    for (std::size_t c = 0; c < after[r].cameras.size(); ++c) {
      const CameraIndex index(count++);
      const RigCamera& stated = calibration.rigs_before[r].cameras[c];
      const RigCamera& fitted = after[r].cameras[c];
      const CameraUncertainty& sure = calibration.uncertainty.cameras[index];
      if (!judge_intrinsics ||
          !differ_surely(stated.model, fitted.model, calibration.uncertainty, index)) {
        continue;
      }
      constexpr double kWorthNaming_px = 1.0;
      const auto corners = seen.find(index);
      const double shift_px =
          corners == seen.end() ? 0 : largest_shift_px(stated.model, fitted.model, corners->second);
      const double focal =
          std::abs(fitted.model.parameters().fu_px / stated.model.parameters().fu_px - 1.0);
      if (focal > std::max(kWorthNamingFocal, kSigmas * sure.focal) || shift_px > kWorthNaming_px) {
        findings.push_back(intrinsics_misfit(stated, fitted, sure, shift_px, rig_refined));
      }
    }
  }
}

void name_survey(const BuiltSubMap& submap, std::vector<Finding>& findings) {
  for (const SurveyResidual& entry : submap.survey) {
    // What was left out has been named with its cause.
    if (!entry.mapped || entry.use == SurveyUse::left_out) continue;
    if (std::abs(entry.residual_m) <= kSurveySigmas * entry.sigma_m) continue;
    Finding finding;
    finding.cause = Cause::survey_entry;
    finding.subject = fmt::format("survey {}", entry.entry);
    finding.text = fmt::format(
        "disagrees with the map: off by {:.1f} mm, {:.1f} times its stated sigma of {:.1f} mm.",
        1e3 * entry.residual_m, std::abs(entry.residual_m) / entry.sigma_m, 1e3 * entry.sigma_m);
    finding.remedy = "Measure it again; if it stands, look at sizes and calibration.";
    finding.figures = {{"residual", entry.residual_m, "m", entry.sigma_m}};
    findings.push_back(finding);
  }
}

/// How sure the scale is that rests on stated sizes and calibration alone.
Finding scale_unknown(const ScaleUncertainty& scale) {
  constexpr double kPpm = 1e6;
  Finding finding;
  finding.cause = Cause::scale_unknown;
  finding.subject = "scale";
  finding.severity = Severity::note;
  finding.figures.push_back({"scale", kPpm * scale.sigma, "ppm", {}});
  std::vector<std::string> parts;
  for (const ScaleUncertainty::Part& part : scale.parts) {
    finding.figures.push_back({std::string(part.of), kPpm * part.sigma, "ppm", {}});
    parts.push_back(fmt::format("{} {:.0f}", part.of, kPpm * part.sigma));
  }
  finding.text = fmt::format(
      "known to ± {:.0f} ppm, one standard deviation, by what rig and sizes are stated to be sure "
      "of (ppm: {}): no measured length tells it.",
      kPpm * scale.sigma, fmt::join(parts, ", "));
  finding.remedy = "Measure a distance on site (survey.toml) where that matters.";
  return finding;
}

/// Sub-maps that the survey's points leave out of the facility frame.
void name_undetermined(const BuildResult& result, std::vector<Finding>& findings) {
  for (std::size_t i = 0; i < result.submaps.size(); ++i) {
    const BuiltSubMap& submap = result.submaps[i];
    if (submap.map.frame == FrameKind::facility) continue;
    std::size_t points = 0;
    std::set<MarkerId> markers;
    for (const SurveyResidual& entry : submap.survey) {
      const bool here =
          std::any_of(submap.map.markers.begin(), submap.map.markers.end(),
                      [&](const MapMarker& marker) { return marker.id == entry.markers.front(); });
      if (!entry.point || entry.use != SurveyUse::fit || !here) continue;
      ++points;
      markers.insert(entry.markers.front());
    }
    Finding finding;
    finding.cause = Cause::survey_entry;
    finding.submap = i;
    finding.subject = fmt::format("sub-map {}", i);
    finding.text = fmt::format(
        "the survey's points do not fix the facility frame for it: {} of them lie on {} of its "
        "markers; it takes 3 for fit, not on a line, on at least 2 "
        "markers.",
        points, markers.size());
    finding.remedy = "Measure more points on markers of this part.";
    finding.figures = {{"points", static_cast<double>(points), "", {}},
                       {"markers with points", static_cast<double>(markers.size()), "", {}}};
    findings.push_back(std::move(finding));
  }
}

Finding rigs_differ(const std::pair<std::string, std::string>& captures) {
  Finding finding;
  finding.cause = Cause::rig_displaced;
  finding.severity = Severity::note;
  finding.subject = fmt::format("{} and {}", captures.first, captures.second);
  finding.text =
      "state different calibrations of the same cameras (they name the same serials); each keeps "
      "its own numbers, and is refined on its own.";
  finding.remedy = "If nothing was changed between them, give both the same rig.yaml.";
  finding.captures = {captures.first, captures.second};
  return finding;
}

}  // namespace

std::vector<Finding> calibration_findings(const BuildResult& result,
                                          const Observations& observations,
                                          const BuildOptions& options) {
  std::vector<Finding> findings;
  const CalibrationResult& calibration = result.calibration;
  if (!calibration.refused.empty()) findings.push_back(refusal(calibration));
  if (!calibration.left_as_stated.empty()) findings.push_back(partial_refusal(calibration));
  name_misfits(calibration, options.refine, seen_corners(result, observations), findings);
  for (std::size_t i = 0; i < result.submaps.size(); ++i) {
    const std::size_t first = findings.size();
    name_survey(result.submaps[i], findings);
    const BuiltSubMap& submap = result.submaps[i];
    if (submap.scale && submap.map.frame == FrameKind::arbitrary) {
      findings.push_back(scale_unknown(*submap.scale));
    }
    for (std::size_t f = first; f < findings.size(); ++f) findings[f].submap = i;
  }
  const auto& points = options.survey.points;
  if (std::any_of(points.begin(), points.end(),
                  [](const SurveyedPoint& point) { return point.use == SurveyUse::fit; })) {
    name_undetermined(result, findings);
  }
  for (const auto& captures : observations.recalibrated) findings.push_back(rigs_differ(captures));
  return findings;
}

}  // namespace waymark
