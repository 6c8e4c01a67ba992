#include "mapbuilder/diagnosis/diagnosed_build.h"

#include <algorithm>
#include <map>

#include "mapbuilder/diagnosis/marker_findings.h"
#include "mapbuilder/diagnosis/table_corrections.h"

namespace waymark {
namespace {

/// The build took fitted sizes for stated ones; users see what they stated.
void restore_stated_sizes(const std::map<MarkerId, double>& stated_m, ObservationTable& table,
                          BuildResult& result) {
  for (std::size_t m = 0; m < table.markers.size(); ++m) {
    const auto stated = stated_m.find(table.markers[m]);
    if (stated != stated_m.end()) table.stated_sizes_m[m] = stated->second;
  }
  for (std::size_t s = 0; s < result.submaps.size(); ++s) {
    for (std::size_t m = 0; m < result.submaps[s].map.markers.size(); ++m) {
      const auto stated = stated_m.find(result.submaps[s].map.markers[m].id);
      if (stated == stated_m.end()) continue;
      result.submaps[s].map.markers[m].stated_size_m = stated->second;
      result.map.submaps[s].markers[m].stated_size_m = stated->second;
    }
  }
}

}  // namespace

DiagnosedBuild build_and_diagnose(ObservationTable& table, const BuildOptions& options,
                                  const DiagnosisOptions& diagnosis_options, Progress& progress) {
  // What was hidden by something worse shows in the second round; a third finds nothing as a rule.
  constexpr int kMostRounds = 3;
  DiagnosedBuild build;
  std::map<MarkerId, double> stated_m;
  // A build may refine the table's rigs and sizes; each starts from what was given.
  ObservationTable given = table;
  build.result = build_map(table, options, progress);
  for (int round = 0; round < kMostRounds; ++round) {
    TableCorrections corrections;
    for (std::size_t s = 0; s < build.result.submaps.size(); ++s) {
      const MapEvidence evidence(table, build.result.submaps[s], options);
      const MarkerDiagnosis diagnosis = diagnose_markers(evidence, diagnosis_options);
      add_corrections(table, diagnosis, corrections);
      auto findings = marker_findings(evidence, diagnosis, s);
      std::move(findings.begin(), findings.end(), std::back_inserter(build.findings));
    }
    if (corrections.empty()) break;
    for (const auto& [marker, size_m] : corrections.sizes_m) {
      const auto m = static_cast<std::size_t>(marker);
      stated_m.emplace(given.markers[m], given.stated_sizes_m[m]);
    }
    given = corrected(given, corrections);
    table = given;
    build.result = build_map(table, options, progress);
  }
  restore_stated_sizes(stated_m, table, build.result);
  return build;
}

}  // namespace waymark
