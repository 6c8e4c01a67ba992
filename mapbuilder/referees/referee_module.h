#pragma once

#include <memory>
#include <vector>

#include "mapbuilder/referees/detector_engine.h"

namespace waymark {

/// What the module of referees gives: `result` becomes the engine's detector of families that it
/// knows; the engine is not `own`.
using MakeRefereeFunction = void(DetectorEngine engine, const std::vector<Family>& families,
                                 double min_side_px, std::unique_ptr<MarkerDetector>& result);

/// The module's file and the name of its function.
inline constexpr const char* kRefereeModule = "libwaymark_referees.so";
inline constexpr const char* kMakeRefereeSymbol = "waymark_make_referee";

}  // namespace waymark

extern "C" waymark::MakeRefereeFunction waymark_make_referee;
