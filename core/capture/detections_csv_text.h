#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/camera/edge_measurement.h"
#include "core/camera/rig.h"
#include "core/capture/detection.h"
#include "core/marker/marker_catalog.h"

namespace waymark {

/// Text of a detections.csv: what was measured of each camera's edges (edge_line; empty, or one a
/// camera), then our own `# detector=…
/// markers=<fingerprint>`; covariance columns when every detection has covariances; corners to 4
/// decimals, covariances to 9 significant digits (so that needle-shaped ones stay positive
/// definite).
[[nodiscard]] std::string format_detections_csv(
    const std::vector<ImageDetections>& images, const Rig& rig, const MarkerCatalog& catalog,
    const std::string& detector, const std::vector<std::optional<EdgeMeasurement>>& edges = {});

/// The same in pieces, for tables that are larger than memory should hold: first the two lines
/// that head the file, then the rows of some images after the other. `with_covariances` is said
/// once for the whole file; then every detection must have them (checked). `with_families`: ids are
/// written "family:number".
[[nodiscard]] std::string detections_csv_head(const MarkerCatalog& catalog,
                                              const std::string& detector, bool with_covariances);
/// Its second line alone, for a table that no catalog stands behind.
[[nodiscard]] std::string detections_csv_columns(bool with_covariances);
void append_detections_csv_rows(const std::vector<ImageDetections>& images, const Rig& rig,
                                bool with_families, bool with_covariances, std::string& text);

}  // namespace waymark
