#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/camera/rig.h"
#include "core/capture/detection.h"
#include "core/capture/edge_line.h"
#include "core/marker/marker_catalog.h"

namespace waymark {

/// Text of a detections.csv: our own `# detector=… markers=<fingerprint>`, then by how much each
/// camera's corners were moved (edge_line; empty, or one a camera); covariance columns when every
/// detection has covariances; corners to 4 decimals, covariances to 9 significant digits (so that
/// needle-shaped ones stay positive definite).
[[nodiscard]] std::string format_detections_csv(const std::vector<ImageDetections>& images,
                                                const Rig& rig, const MarkerCatalog& catalog,
                                                const std::string& detector,
                                                const std::vector<EdgeMove>& moves = {});

/// The same in pieces, for tables that are larger than memory should hold: first the lines that
/// head the file, then the rows of some images after the other. `with_covariances` is said once for
/// the whole file; then every detection must have them (checked). `with_families`: ids are written
/// "family:number".
[[nodiscard]] std::string detections_csv_head(const MarkerCatalog& catalog,
                                              const std::string& detector, bool with_covariances,
                                              const Rig& rig = {},
                                              const std::vector<EdgeMove>& moves = {});
/// Its last line alone, for a table that no catalog stands behind.
[[nodiscard]] std::string detections_csv_columns(bool with_covariances);
void append_detections_csv_rows(const std::vector<ImageDetections>& images, const Rig& rig,
                                bool with_families, bool with_covariances, std::string& text);

}  // namespace waymark
