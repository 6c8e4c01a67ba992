#include "mapbuilder/diagnosis/diagnosed_build.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/base/parallel.h"
#include "mapbuilder/diagnosis/marker_corrections.h"
#include "mapbuilder/diagnosis/marker_findings.h"

namespace waymark {
namespace {

/// The observations that a map rests on: those that no gate rejects.
std::set<ObservationIndex> mapped_observations(const BuildResult& result) {
  std::set<ObservationIndex> mapped;
  for (const BuiltSubMap& submap : result.submaps) {
    for (const ObservationResidual& residual : submap.residuals) {
      if (residual.accepted) mapped.insert(residual.observation);
    }
  }
  return mapped;
}

/// Relative difference of two fitted sizes that no map feels.
constexpr double kSameSize = 0.002;

/// Whether a map built with corrections would be another one than that built with those before:
/// what the gate keeps out of it already changes nothing.
bool would_change(const Corrections& before, const Corrections& after,
                  const std::set<ObservationIndex>& mapped) {
  const bool acquitted =
      std::any_of(before.left_out.begin(), before.left_out.end(),
                  [&](ObservationIndex index) { return !after.left_out.contains(index); });
  const bool condemned =
      std::any_of(after.left_out.begin(), after.left_out.end(),
                  [&](ObservationIndex index) { return mapped.contains(index); });
  const bool same_sizes = std::equal(
      before.sizes_m.begin(), before.sizes_m.end(), after.sizes_m.begin(), after.sizes_m.end(),
      [](const auto& a, const auto& b) {
        return a.first == b.first && std::abs(a.second - b.second) <= kSameSize * a.second;
      });
  return acquitted || condemned || !same_sizes;
}

/// What is wrong in all components. The prepared observations must outlive it.
std::vector<MarkerDiagnosis> diagnose(const PreparedObservations& prepared,
                                      const BuildResult& result, const BuildOptions& options,
                                      const DiagnosisOptions& diagnosis_options) {
  std::vector<MarkerDiagnosis> diagnoses;
  const auto& components = prepared.selection().components();
  for (const ComponentIndex c : components.indices()) {
    if (components[c].markers.size() < 2) continue;
    const MapEvidence evidence(prepared, result.evidence(), c, options);
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

}  // namespace

DiagnosedBuild build_and_diagnose(const Observations& observations, const BuildOptions& options,
                                  const DiagnosisOptions& diagnosis_options, Progress& progress,
                                  std::optional<BuildResult> first) {
  // One build where nothing is wrong; what something worse hid, or made look wrong, shows in the
  // second and third.
  constexpr int kMostBuilds = 5;
  const bool as_stated = !options.refine.any() && options.survey.empty();
  DiagnosedBuild build;
  Corrections corrections;
  std::optional<Estimate> start;
  for (int builds = 1;; ++builds) {
    const Selection selection(observations, corrections);
    build.result = first ? *std::exchange(first, std::nullopt)
                         : build_map(selection, options, progress, std::move(start));
    start.reset();
    const PreparedObservations prepared(selection, build.result.evidence(),
                                        effective_threads(options.threads));
    const auto diagnoses = diagnose(prepared, build.result, options, diagnosis_options);
    Corrections better = corrections_for(selection, diagnoses);
    const bool changes = would_change(corrections, better, mapped_observations(build.result));
    if (changes && builds < kMostBuilds) {
      // Where sizes alone change, the map of all other markers stands.
      if (as_stated && better.left_out == corrections.left_out) start = build.result.estimate;
      corrections = std::move(better);
      continue;
    }
    for (const MarkerDiagnosis& diagnosis : diagnoses) {
      for (Finding& finding : marker_findings(observations, diagnosis)) {
        build.findings.push_back(std::move(finding));
      }
    }
    if (changes) {
      // No end of it: nothing that is named may stay in.
      better.left_out.insert(corrections.left_out.begin(), corrections.left_out.end());
      build.result = build_map(Selection(observations, better), options, progress);
    }
    break;
  }
  for (Finding& finding : build.findings) {
    finding.submap = submap_of(build.result, finding.markers.front());
  }
  return build;
}

}  // namespace waymark
