#include "mapbuilder/referees/referee_module.h"

#include "core/base/check.h"
#include "mapbuilder/referees/apriltag_detector.h"
#include "mapbuilder/referees/aruco_detector.h"

void waymark_make_referee(waymark::DetectorEngine engine,
                          const std::vector<waymark::Family>& families, double min_side_px,
                          std::unique_ptr<waymark::MarkerDetector>& result) {
  WAYMARK_CHECK(engine != waymark::DetectorEngine::own);
  if (engine == waymark::DetectorEngine::opencv) {
    result = std::make_unique<waymark::ArucoDetector>(families, min_side_px);
  } else {
    result = std::make_unique<waymark::ApriltagDetector>(families, min_side_px);
  }
}
