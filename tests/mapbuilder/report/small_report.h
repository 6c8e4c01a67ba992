#pragma once

#include "mapbuilder/report/report.h"
#include "tests/support/small_map.h"

namespace waymark::test {

/// A report of two sub-maps with a value in every field; names as hostile as file names can be.
inline Report small_report() {
  Report report;
  report.map_name = "</script><img src=x onerror=alert(1)>.map";
  report.map = small_map();
  report.captures = {{"/data/\"hall\" & <b>yard</b>", "00000000000000aa"},
                     {"not UTF-8: \xff\xfe", "00000000000000bb"}};
  report.cameras = {{"cam0", 640, 480, {319.5, 239.5}}, {"cam1", 480, 640, {239.5, 319.5}}};
  const auto at = [](double x, double y) {
    return ImageCorners{{{x, y}, {x + 40, y}, {x + 40, y + 40}, {x, y + 40}}};
  };
  const Eigen::Vector2d right(0.5, 0);
  const Eigen::Vector2d down(0, 0.25);
  const MarkerId twelve{Family::tag36h11, 12};
  report.observations = {{twelve, 0, true, at(319.5, 219.5), {right, right, right, right}},
                         {twelve, 1, true, at(20, 20), {down, down, down, down}},
                         {twelve, 0, false, at(100, 100), {right * 100, right, right, right}}};
  ReportSubMap first;
  ReportTrack track;
  track.capture = report.captures[0].name;
  track.poses = {{Stamp{1'000'000'000}, {Eigen::Quaterniond::Identity(), {1, 0, 0}}},
                 {Stamp{2'000'000'000}, {Eigen::Quaterniond::Identity(), {1, 1, 0}}}};
  track.true_poses = track.poses;
  track.rmse_to_true = PoseRmse{0.004, 0.001};
  first.tracks = {track};
  first.observations = 3;
  first.rejected = 1;
  first.ambiguous = 2;
  first.corner_sigma_px = 0.125;
  first.covariances_known = true;
  first.camera_up_in_world = {0, 0, 1};
  ReportSubMap second;
  second.observations = 4;
  report.submaps = {first, second};
  report.survey = {{"3 bottom-left to 12 bottom-left",
                    {{Family::tag36h11, 3}, twelve},
                    false,
                    false,
                    1.5,
                    1.503,
                    0.003,
                    0.0016},
                   {"99 center", {{Family::tag36h11, 99}}, true, true, {}, {}, {}, 0.002}};
  Finding finding;
  finding.cause = Cause::size;
  finding.severity = Severity::error;
  finding.subject = "marker 12";
  finding.text = "is 121 mm, <not> 120 mm: its 22 views fit 121.0 mm, 5 sigmas off.";
  finding.explains = "22 views of it";
  finding.remedy = "Measure it and correct markers.toml.";
  finding.markers = {twelve};
  finding.cameras = {"cam0"};
  finding.captures = {report.captures[0].name};
  finding.submap = 0;
  finding.figures = {{"fitted size", 0.121, "m", 0.0002}, {"stated size", 0.12, "m", {}}};
  report.findings = {finding};
  report.unmapped = {{Family::tag36h11, 99}};
  report.unlocalized = 3;
  report.without_markers = 4;
  return report;
}

}  // namespace waymark::test
