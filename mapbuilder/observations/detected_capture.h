#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/camera/edge_measurement.h"
#include "core/camera/rig.h"
#include "core/camera/rig_fingerprint.h"
#include "core/capture/detection.h"
#include "core/capture/edge_line.h"
#include "core/capture/frame_set.h"
#include "core/marker/marker_catalog.h"

namespace waymark {

/// A capture with its detections made or read: what mapping starts from.
struct DetectedCapture {
  std::string name;  ///< for messages
  Rig rig;
  MarkerCatalog catalog;
  std::vector<ImageDetections> images;  ///< by rising (stamp, camera)
  Stamp sync_tolerance = kDefaultSyncTolerance;
  bool monotonic = false;  ///< its stamps can't be compared with another capture's
  /// Rows of its detections.csv of a stated family that markers.toml neither sizes nor ignores.
  std::map<MarkerId, int> unlisted{};
  /// Per camera by how much corners were moved outward, where that was measured in the capture's
  /// own images; empty or nullopt where it was not.
  std::vector<std::optional<EdgeMeasurement>> edges{};
};

/// 16 hexadecimal digits that depend on a capture's rig and detections and nothing else.
[[nodiscard]] std::string fingerprint(const DetectedCapture& capture);
/// Of all different rigs together; of one its own.
[[nodiscard]] std::string fingerprint(std::span<const Rig> rigs);

/// By how much each camera's corners have been moved outward, for those who write them down.
[[nodiscard]] std::vector<EdgeMove> edge_moves(const DetectedCapture& capture);

/// Whether two rigs are one: the same names and numbers, and no serial that says otherwise.
[[nodiscard]] bool are_same(const Rig& a, const Rig& b);

/// Whether both rigs state all their cameras' serials, and these are alike.
[[nodiscard]] bool have_same_serials(const Rig& a, const Rig& b);

/// The canonical order of the detections in one image: by marker, then by corners.
[[nodiscard]] std::vector<const Detection*> in_canonical_order(
    const std::vector<Detection>& detections);

}  // namespace waymark
