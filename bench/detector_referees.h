#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "mapbuilder/referees/detector_engine.h"

namespace waymark::bench {

/// A detector and what tables call it.
struct NamedDetector {
  std::string name;
  std::unique_ptr<MarkerDetector> detector;
};

/// All that find markers of the family: ours, OpenCV as this project sets it up, OpenCV with its
/// own settings, and for tags libapriltag at half resolution and at full.
[[nodiscard]] std::vector<NamedDetector> all_detectors(Family family);

}  // namespace waymark::bench
