// Writes a report with everything in it, for the browser test: a room built from its detections,
// with findings of every severity, a survey, the truth, and names as hostile as file names can be.
// Usage: sample_report FOLDER

#include <cstdio>

#include "mapbuilder/report/report_folder.h"
#include "mapbuilder/report/report_of_build.h"
#include "tests/mapbuilder/observations/room_observations.h"
#include "tests/mapbuilder/report/small_report.h"

namespace waymark {
namespace {

Report sample_report() {
  test::RoomOptions options;
  options.noise_px = 0.2;
  const test::SyntheticRoom room = test::make_room(options);
  Observations observations = test::observations_of(room);
  Progress progress;
  const BuildResult result = build_map(Selection(observations), {}, progress);
  CaptureTruth truth{"room", room.rig, {}};
  for (std::size_t i = 0; i < room.world_from_rig.size(); ++i) {
    truth.world_from_rig.push_back({test::room_stamp(static_cast<int>(i)), room.world_from_rig[i]});
  }
  Report report = report_of_build(result, observations, {truth});
  const Report hostile = test::small_report();
  report.map_name = hostile.map_name;
  report.captures[0].name = hostile.captures[0].name;
  report.survey = hostile.survey;
  const std::vector<MapMarker>& markers = report.map.submaps[0].markers;
  for (const Severity severity : {Severity::note, Severity::warning, Severity::error}) {
    Finding finding = hostile.findings[0];
    finding.severity = severity;
    finding.markers = {markers[4 + static_cast<std::size_t>(severity)].id};
    report.findings.push_back(finding);
  }
  return report;
}

}  // namespace
}  // namespace waymark

int main(int argc, char** argv) {
  if (argc != 2) return 64;
  auto folder = waymark::ReportFolder::write(argv[1], waymark::sample_report());
  const waymark::Status status =
      folder ? folder->put_in_place() : waymark::Status(tl::make_unexpected(folder.error()));
  if (status) return 0;
  std::fprintf(stderr, "sample_report: %s\n", status.error().message.c_str());
  return status.error().exit_code();
}
