#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/camera/rig.h"
#include "core/capture/detections_csv.h"
#include "core/marker/marker_catalog.h"

namespace waymark {

/// Brings the corners of a table to where the rig, as it is stated now, has them: what was moved by
/// a stated bias, or not at all, moves on to the `edge_bias_px` of now (0 where none is stated),
/// exactly. What was moved marker by marker, as images told, stays: it needs no stated bias, and
/// one that lies further from the measured one than three sigmas is bad_data (stale: detect again).
/// A camera of which the file does not say stays, too. `name` stands for the file.
[[nodiscard]] Status move_edges_on(const Rig& rig, const MarkerCatalog& catalog,
                                   const std::string& name, DetectionsTable& table);

/// Counts with corners that may not have been moved: of each camera whose edge bias is stated and
/// of which the table's file does not say by how much its corners were moved, the edges' sigma
/// becomes the bias at least. Gives back the names of these cameras.
std::vector<std::string> widen_for_unknown_moves(const DetectionsTable& table, Rig& rig);

}  // namespace waymark
