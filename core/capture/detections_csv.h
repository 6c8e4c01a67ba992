#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/camera/rig.h"
#include "core/capture/detection.h"
#include "core/capture/edge_line.h"
#include "core/marker/marker_catalog.h"

namespace waymark {

/// detections.csv as read: images by rising (stamp, camera), each image's detections by rising
/// (marker id, then corners), so that the order of the rows leaves no trace.
struct DetectionsTable {
  std::vector<ImageDetections> images;
  std::string detector;             ///< from our own first line, empty otherwise
  std::string markers_fingerprint;  ///< likewise
  /// By how much each camera's corners were moved outward before they were written; nullopt, or
  /// empty, where the file does not say.
  std::vector<std::optional<EdgeMove>> moves;
  int unknown_markers = 0;           ///< rows whose marker the catalog ignores or lacks; left out
  std::map<MarkerId, int> unlisted;  ///< of these, those that it lacks: rows of each
  /// Rows whose corners do not run clockwise in the image, as top-left, top-right, bottom-right,
  /// bottom-left do wherever the camera stands; left out. Many: another tool's corner order.
  int misordered = 0;
};

/// Reads detections.csv: columns by header name (FORMATS: t_ns,camera,marker_id,x0…y3
/// [,hamming,family,sxx0,sxy0,syy0,…3]); BOM and CRLF allowed; empty marker_id = image seen,
/// nothing found. `camera` is a name of the rig. Read line by line; memory is that of the result.
/// bad_data with the line's number for: a missing or doubled column, a row of another length, a
/// stamp that is no integer, an unknown camera or family, a number outside its family, corners that
/// are NaN or beyond ±1e6 px, a covariance that is not positive definite, a line of more than
/// 64 KiB or 64 columns; for a file as other programs write it, whose error says so (foreign_csv,
/// doubt_of_stamps); for a sparse one and one beyond 4 GiB; and when mapbuilder wrote the file for
/// other markers than `catalog`, or with measured edges that rig.yaml contradicts (stale). Corners
/// are as the rig's `edge_bias_px` has them (move_edges_on). no_input when absent. `monotonic` as
/// for doubt_of_stamps.
[[nodiscard]] Expected<DetectionsTable> read_detections_csv(const std::filesystem::path& path,
                                                            const Rig& rig,
                                                            const MarkerCatalog& catalog,
                                                            bool monotonic = false);

}  // namespace waymark
