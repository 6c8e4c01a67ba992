#include "mapbuilder/commands/calibrate_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/base/atomic_file.h"
#include "core/base/is_there.h"
#include "core/base/output_check.h"
#include "core/base/same_file.h"
#include "core/camera/kalibr.h"
#include "core/geometry/degrees.h"
#include "mapbuilder/build/output_paths.h"
#include "mapbuilder/commands/build_summary.h"
#include "mapbuilder/commands/print_line.h"
#include "mapbuilder/diagnosis/clock_findings.h"
#include "mapbuilder/report/report_folder.h"
#include "mapbuilder/report/report_of_build.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

/// A capture that has no rig file may be given the one that is found.
bool is_missing_rig_file(const fs::path& output, const std::vector<fs::path>& captures) {
  return !is_there(output) && std::any_of(captures.begin(), captures.end(), [&](const auto& one) {
    return is_same_file(output, one / "rig.yaml");
  });
}

Status check_outputs(const CalibrateCommandOptions& options) {
  if (!is_missing_rig_file(options.output, options.input.paths)) {
    if (auto spares = check_spares_input(options.output, options.input, {}); !spares) {
      return spares;
    }
  }
  for (const fs::path& path : {options.output, rejected_path(options.output)}) {
    if (auto writable = check_writable(path); !writable) return writable;
  }
  if (options.report) return check_report_folder(*options.report);
  return {};
}

Status check_are_folders(const std::vector<fs::path>& paths) {
  for (const fs::path& path : paths) {
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) continue;
    return fail(ErrorKind::usage,
                "{}: a file; calibrate takes capture folders (of a video, a folder cam0 with its "
                "frames)",
                path.string());
  }
  return {};
}

/// Whether detections come from images, whose markers are found better by the lens that took them.
bool any_from_images(const CaptureInput& input) {
  return input.detect.redetect ||
         std::any_of(input.paths.begin(), input.paths.end(),
                     [](const fs::path& path) { return !is_there(path / "detections.csv"); });
}

bool any_bends(const Rig& rig) {
  return std::any_of(rig.cameras.begin(), rig.cameras.end(), [](const RigCamera& camera) {
    return camera.model.parameters().distortion != Distortion::none;
  });
}

void append(std::vector<Finding> more, std::vector<Finding>& findings) {
  for (Finding& finding : more) findings.push_back(std::move(finding));
}

/// The rig that stands at `path`, if it is one of these cameras.
std::optional<Rig> rig_before(const fs::path& path, const Rig& found) {
  if (!is_there(path)) return std::nullopt;
  auto before = read_camchain(path);
  if (!before || before->rig.cameras.size() != found.cameras.size()) return std::nullopt;
  for (std::size_t k = 0; k < found.cameras.size(); ++k) {
    const CameraParameters& a = before->rig.cameras[k].model.parameters();
    const CameraParameters& b = found.cameras[k].model.parameters();
    if (a.width_px != b.width_px || a.height_px != b.height_px) return std::nullopt;
  }
  return std::move(before->rig);
}

/// An error where the rig that would be replaced fits the captures better.
std::vector<Finding> compare_with_before(const CalibrateCommandOptions& options,
                                         const std::vector<DetectedCapture>& captures,
                                         const RigCalibration& calibration, Progress& progress) {
  // Less is noise: the same corners, other gates.
  constexpr double kBetter = 0.97;
  const auto before = rig_before(options.output, calibration.rig);
  if (!before) return {};
  const bool had_places = before->cameras.size() < 2 || before->has_extrinsics;
  const bool has_places = calibration.rig.cameras.size() < 2 || calibration.rig.has_extrinsics;
  const auto fit = fit_of_rig(captures, *before, options.calibration.build, progress);
  const bool lost_places = had_places && !has_places;
  const bool fits_worse =
      fit && had_places == has_places && fit->joint_px < kBetter * calibration.quality.joint_px;
  if (!lost_places && !fits_worse) return {};
  Finding finding;
  finding.severity = Severity::error;
  finding.cause = Cause::intrinsics;
  finding.subject = options.output.filename().string();
  finding.text = lost_places
                     ? "what stands there says where the cameras are, and these captures do not."
                     : fmt::format(
                           "what stands there fits these captures better: {:.3f} px "
                           "against {:.3f} px.",
                           fit->joint_px, calibration.quality.joint_px);
  finding.remedy = "Keep it, or name another file.";
  return {finding};
}

std::string numbers_of(const RigCamera& camera) {
  const CameraParameters& p = camera.model.parameters();
  const StatedSigmas& sigmas = camera.stated_sigmas;
  const auto give = [](double value, std::optional<double> sigma) {
    return sigma ? give_or_take(value, *sigma, "", 1) : fmt::format("{:.1f} (held)", value);
  };
  const auto focal_sigma =
      sigmas.focal ? std::optional(*sigmas.focal * p.fu_px) : std::optional<double>{};
  return fmt::format("{}, focal length {} px, principal point {}, {} px", to_string(p.distortion),
                     give(p.fu_px, focal_sigma), give(p.pu_px, sigmas.principal_px),
                     give(p.pv_px, sigmas.principal_px));
}

std::string place_of(const RigCamera& camera, const RigCamera& first) {
  const Rigid3 first_from_cam = first.rig_from_cam.inverse() * camera.rig_from_cam;
  const double distance_mm = 1e3 * first_from_cam.translation.norm();
  const double sigma_mm = 1e3 * camera.stated_sigmas.position_m.value_or(0);
  const double turn_deg = kDegreesPerRadian * angle_between_rad(first_from_cam.rotation,
                                                                Eigen::Quaterniond::Identity());
  const double sigma_deg = kDegreesPerRadian * camera.stated_sigmas.rotation_rad.value_or(0);
  return fmt::format("; {} and {} from {}", give_or_take(distance_mm, sigma_mm, " mm", 1),
                     give_or_take(turn_deg, sigma_deg, "°", 2), first.name);
}

std::string verdict_of(const ImageCoverage& coverage) {
  std::string text =
      fmt::format("{}: markers cover {:.0f} % of the image", coverage.camera, 100 * coverage.share);
  for (std::size_t i = 0; i < coverage.empty.size(); ++i) {
    text += fmt::format("; no marker in the {} third of {}: {}", coverage.empty[i], coverage.camera,
                        coverage.remedies[i]);
  }
  return coverage.empty.empty() ? text + "; nothing is missing" : text;
}

std::string text_of_halves(const std::optional<double>& apart) {
  if (!apart)
    return "two halves of the images: one of them does not tell the rig, so that nothing confirms "
           "the sigmas";
  return fmt::format(
      "two halves of the images: their rigs differ by {:.2f} times what they state{}", *apart,
      *apart > 1 ? ", and all sigmas are so much larger" : "");
}

void print_calibration(const RigCalibration& calibration, std::ostream& out) {
  const Rig& rig = calibration.rig;
  for (std::size_t k = 0; k < rig.cameras.size(); ++k) {
    const bool has_place = k > 0 && rig.has_extrinsics;
    print_line(out, "{}: {}{}", rig.cameras[k].name, numbers_of(rig.cameras[k]),
               has_place ? place_of(rig.cameras[k], rig.cameras.front()) : "");
    print_line(out, "{}", verdict_of(calibration.coverage[k]));
  }
}

Expected<ReportFolder> write_report(const CalibrateCommandOptions& options,
                                    const RigCalibration& calibration,
                                    const std::vector<Finding>& findings) {
  Report report = report_of_build(calibration.result, calibration.observations, {});
  report.findings = findings;
  report.map_name = options.output.filename().string();
  return ReportFolder::write(*options.report, report);
}

/// The rig by detections as they are; in images once more by the lenses found.
Expected<RigCalibration> calibrate(const CalibrateCommandOptions& options,
                                   std::vector<DetectedCapture>& captures, Progress& progress,
                                   std::ostream& notes) {
  const RigCalibrationOptions& how = options.calibration;
  auto found = find_rig(captures, how, progress);
  if (!found) return tl::make_unexpected(found.error());
  for (std::size_t k = 0; k < found->rig.cameras.size(); ++k) {
    print_line(notes, "{}: lens by evidence (the least explains best): {}",
               found->rig.cameras[k].name, found->lenses[k]);
  }
  auto calibration = calibrate_rig(captures, *found, how, progress);
  if (!calibration || !any_from_images(options.input) || !any_bends(calibration->rig)) {
    return calibration;
  }
  found->rig = calibration->rig;
  CaptureInput again = options.input;
  again.known_rig = calibration->rig;
  std::ostream unheard(nullptr);  // the same notes as the first time
  auto taken = take_captures_in(again, progress, unheard);
  if (!taken) return tl::make_unexpected(taken.error());
  print_line(notes, "note: markers are found again, by the lenses that took them");
  captures = std::move(taken->captures);
  return calibrate_rig(captures, *found, how, progress);
}

}  // namespace

Status run_calibrate(const CalibrateCommandOptions& given, Progress& progress, std::ostream& out,
                     std::ostream& notes) {
  CalibrateCommandOptions options = given;
  options.input.rig_file = RigFile::optional;
  options.calibration.build.threads = options.input.detect.threads;
  if (auto folders = check_are_folders(options.input.paths); !folders) return folders;
  if (auto allowed = check_outputs(options); !allowed) return allowed;
  if (auto fine = options.calibration.build.check(); !fine) return fine;
  auto taken = take_captures_in(options.input, progress, notes);
  if (!taken) return tl::make_unexpected(taken.error());
  std::vector<Finding> findings = std::move(taken->findings);
  append(clock_findings(taken->captures), findings);
  findings = judged(std::move(findings), options.rules);
  if (!may_stand(findings, options.rules)) {
    print_findings(findings, notes);
    return tl::make_unexpected(
        refusal_of(options.output.string(), findings, "nothing was calibrated by such input"));
  }
  auto calibration = calibrate(options, taken->captures, progress, notes);
  if (!calibration) {
    print_findings(findings, notes);
    return tl::make_unexpected(calibration.error());
  }
  append(calibration->findings, findings);
  append(compare_with_before(options, taken->captures, *calibration, progress), findings);
  findings = judged(std::move(findings), options.rules);
  print_findings(findings, notes);
  std::optional<ReportFolder> report;
  if (options.report) {
    auto written = write_report(options, *calibration, findings);
    if (!written) return tl::make_unexpected(written.error());
    report.emplace(std::move(*written));
  }
  const bool stands = may_stand(findings, options.rules);
  const fs::path place = stands ? options.output : rejected_path(options.output);
  if (auto written = write_file_atomically(place, format_camchain(calibration->rig)); !written) {
    return written;
  }
  if (report) {
    if (auto placed = report->put_in_place(); !placed) return placed;
  }
  print_calibration(*calibration, out);
  print_line(out, "{}", text_of_halves(calibration->halves_apart));
  print_summary(calibration->result, out);
  print_line(out, "{}: rig of {} cameras", place.string(), calibration->rig.cameras.size());
  if (stands) return {};
  return tl::make_unexpected(refusal_of(options.output.string(), findings,
                                        fmt::format("the rig went to {}", place.string())));
}

}  // namespace waymark
