#include "mapbuilder/diagnosis/diagnosed_build.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "mapbuilder/diagnosis/marker_findings.h"
#include "mapbuilder/diagnosis/table_corrections.h"

namespace waymark {
namespace {

/// The given table's observations that a map rests on: those that no gate rejects.
std::set<std::size_t> mapped_observations(const CorrectedTable& corrected,
                                          const BuildResult& result) {
  std::set<std::size_t> mapped;
  for (const BuiltSubMap& submap : result.submaps) {
    for (const ObservationResidual& residual : submap.residuals) {
      if (residual.accepted) mapped.insert(corrected.given_index[residual.observation]);
    }
  }
  return mapped;
}

/// Relative difference of two fitted sizes that no map feels.
constexpr double kSameSize = 0.002;

/// Whether a map built with corrections would be another one than that built with those before:
/// what the gate keeps out of it already changes nothing.
bool would_change(const TableCorrections& before, const TableCorrections& after,
                  const std::set<std::size_t>& mapped) {
  const bool acquitted =
      std::any_of(before.left_out.begin(), before.left_out.end(),
                  [&](std::size_t index) { return !after.left_out.contains(index); });
  const bool condemned = std::any_of(after.left_out.begin(), after.left_out.end(),
                                     [&](std::size_t index) { return mapped.contains(index); });
  const bool same_sizes = std::equal(
      before.sizes_m.begin(), before.sizes_m.end(), after.sizes_m.begin(), after.sizes_m.end(),
      [](const auto& a, const auto& b) {
        return a.first == b.first && std::abs(a.second - b.second) <= kSameSize * a.second;
      });
  return acquitted || condemned || !same_sizes;
}

/// What is wrong in all components of a built table.
std::vector<MarkerDiagnosis> diagnose(const BuildResult& result, const BuildOptions& options,
                                      const DiagnosisOptions& diagnosis_options,
                                      const std::vector<double>& stated_sizes_m,
                                      ObservationTable& table) {
  std::vector<MarkerDiagnosis> diagnoses;
  for (const ComponentFit& fit : result.calibration.fits) {
    if (fit.component.markers.size() < 2) continue;
    const MapEvidence evidence(table, fit, options, stated_sizes_m);
    diagnoses.push_back(diagnose_markers(evidence, diagnosis_options));
  }
  return diagnoses;
}

/// The sub-map that holds a marker; nullopt: none does.
std::optional<std::size_t> submap_of(const BuildResult& result, MarkerId marker) {
  for (std::size_t s = 0; s < result.submaps.size(); ++s) {
    for (const MapMarker& mapped : result.submaps[s].map.markers) {
      if (mapped.id == marker) return s;
    }
  }
  return std::nullopt;
}

/// The build took fitted sizes for stated ones; users see what they stated.
void restore_stated_sizes(const TableCorrections& corrections,
                          const std::vector<double>& stated_sizes_m, ObservationTable& table,
                          BuildResult& result) {
  for (const auto& [marker, fitted_m] : corrections.sizes_m) {
    const auto m = static_cast<std::size_t>(marker);
    table.stated_sizes_m[m] = stated_sizes_m[m];
    for (std::size_t s = 0; s < result.submaps.size(); ++s) {
      for (std::size_t i = 0; i < result.submaps[s].map.markers.size(); ++i) {
        if (result.submaps[s].map.markers[i].id != table.markers[m]) continue;
        result.submaps[s].map.markers[i].stated_size_m = stated_sizes_m[m];
        result.map.submaps[s].markers[i].stated_size_m = stated_sizes_m[m];
      }
    }
  }
}

}  // namespace

DiagnosedBuild build_and_diagnose(ObservationTable& table, const BuildOptions& options,
                                  const DiagnosisOptions& diagnosis_options, Progress& progress) {
  // One build where nothing is wrong; what something worse hid, or made look wrong, shows in the
  // second and third.
  constexpr int kMostBuilds = 5;
  // A build may refine the table's rigs and sizes; each starts from what was given.
  const ObservationTable given = table;
  DiagnosedBuild build;
  TableCorrections corrections;
  CorrectedTable corrected = uncorrected(std::move(table));
  for (int builds = 1;; ++builds) {
    build.result = build_map(corrected.table, options, progress);
    const auto diagnoses =
        diagnose(build.result, options, diagnosis_options, given.stated_sizes_m, corrected.table);
    TableCorrections better = corrections_for(corrected, diagnoses);
    if (builds < kMostBuilds &&
        would_change(corrections, better, mapped_observations(corrected, build.result))) {
      corrections = better;
      corrected = correct(given, corrections);
      continue;
    }
    // Before the table that the views point into is replaced.
    for (const MarkerDiagnosis& diagnosis : diagnoses) {
      for (Finding& finding : marker_findings(corrected.table, diagnosis)) {
        build.findings.push_back(std::move(finding));
      }
    }
    if (would_change(corrections, better, mapped_observations(corrected, build.result))) {
      // No end of it: nothing that is named may stay in.
      better.left_out.insert(corrections.left_out.begin(), corrections.left_out.end());
      corrections = std::move(better);
      corrected = correct(given, corrections);
      build.result = build_map(corrected.table, options, progress);
    }
    for (Finding& finding : build.findings) {
      finding.submap = submap_of(build.result, finding.markers.front());
    }
    break;
  }
  table = std::move(corrected.table);
  restore_stated_sizes(corrections, given.stated_sizes_m, table, build.result);
  return build;
}

}  // namespace waymark
