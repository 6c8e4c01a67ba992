#include "locd/service/map_rig_notes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/camera/rig_fingerprint.h"
#include "core/camera/rig_parameters.h"
#include "core/estimate/calibration_prior.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

/// The rig file that mapbuilder writes beside a map.
fs::path rig_beside(fs::path map_path) { return map_path.replace_extension(".yaml"); }

void warn_of_edges(const MarkerMap& map, const fs::path& map_path, const Rig& rig,
                   const fs::path& rig_path, std::vector<std::string>& warnings) {
  std::vector<std::string> cameras;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    if (rig.cameras[c].edge_bias_px || !knows_edges_better(map.submaps.front(), rig, c)) continue;
    cameras.push_back(rig.cameras[c].name);
  }
  if (cameras.empty()) return;
  warnings.push_back(fmt::format(
      "{}: how far inside the black edges are seen by {} was measured when the map was built, {} "
      "does not state it (edge_bias_px): markers look up to 1 % too far. Use the rig file that "
      "mapbuilder wrote beside the map: {}",
      map_path.string(), fmt::join(cameras, ", "), rig_path.string(),
      rig_beside(map_path).string()));
}

/// Errors of cameras and markers are known to be the same ones only where the calibration is.
bool has_other_calibration(const MarkerMap& map, const Rig& rig) {
  return map.considered() && !map.rig_fingerprint.empty() &&
         map.rig_fingerprint != fingerprint(rig);
}

void tell_of_map(const MarkerMap& map, const fs::path& map_path, std::vector<std::string>& notes) {
  if (map.submaps.size() > 1) {
    notes.push_back(fmt::format("{} holds {} sub-maps; poses are in the first, the largest",
                                map_path.string(), map.submaps.size()));
  }
  const auto& markers = map.submaps.front().markers;
  const auto unknown = std::count_if(markers.begin(), markers.end(),
                                     [](const MapMarker& m) { return !m.covariance_known(); });
  if (unknown > 0) {
    notes.push_back(fmt::format(
        "{}: the uncertainty of {} of {} markers is unknown; no pose that rests on them will be OK",
        map_path.string(), unknown, markers.size()));
  }
}

}  // namespace

MapRigNotes map_rig_notes(const MarkerMap& map, const fs::path& map_path, const Rig& rig,
                          const fs::path& rig_path) {
  MapRigNotes told;
  if (map.submaps.empty()) return told;
  warn_of_edges(map, map_path, rig, rig_path, told.warnings);
  tell_of_map(map, map_path, told.notes);
  if (has_other_calibration(map, rig)) {
    told.notes.push_back(fmt::format(
        "{}: built with another calibration than {}; poses count with both as independent. Where "
        "the map was built with --refine, use the rig file that was written beside it: {}",
        map_path.string(), rig_path.string(), rig_beside(map_path).string()));
  }
  if (auto note = note_of_default_sigmas(rig, rig_path.string())) {
    told.notes.push_back(*std::move(note));
  }
  return told;
}

}  // namespace waymark
