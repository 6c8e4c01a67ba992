#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/detect/marker_detector.h"
#include "core/marker/marker_catalog.h"

namespace waymark {

/// Who finds and decodes markers.
enum class DetectorEngine {
  own,       ///< core/detect: every family
  opencv,    ///< the ArUco families, aruco_mip_36h12 and AprilTag's first ones
  apriltag,  ///< libapriltag: the tag* families
};

/// As `--detector` has them: own, opencv, apriltag.
[[nodiscard]] std::string_view name_of(DetectorEngine engine);

/// Whether the engine decodes the family, and as an inverted print.
[[nodiscard]] bool engine_knows(DetectorEngine engine, Family family, bool inverted = false);

/// The engine's detector of a catalog's markers (at least one family; checked). usage where it does
/// not know one of the families, `name` stands for catalog or capture then; unavailable where the
/// module of referees can't be loaded.
[[nodiscard]] Expected<std::unique_ptr<MarkerDetector>> make_detector(
    DetectorEngine engine, const MarkerCatalog& catalog, const std::string& name,
    double min_side_px = DetectorOptions{}.min_side_px);

}  // namespace waymark
