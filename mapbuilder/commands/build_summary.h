#pragma once

#include <ostream>

#include "mapbuilder/build/map_builder.h"

namespace waymark {

/// A line per sub-map: how many markers and frame sets, what is ambiguous or rejected, RMS (px)
/// over accepted and over all observations, and what a corner is good for (px).
void print_summary(const BuildResult& result, std::ostream& out);

/// A line per survey entry whose markers are mapped: how it was used, and how far it is off (mm and
/// its own sigmas).
void print_survey(const BuildResult& result, std::ostream& out);

}  // namespace waymark
