#pragma once

#include "mapbuilder/calibration/calibration_options.h"
#include "mapbuilder/growth/mapper_options.h"

namespace waymark {

/// Options of a build: those of the mapper and those of the calibration. Defaults are what
/// `mapbuilder build` uses.
struct BuildOptions : MapperOptions, CalibrationOptions {};

/// Error: usage, naming the field and its range.
[[nodiscard]] inline Status check(const BuildOptions& options) {
  if (auto fine = check(static_cast<const MapperOptions&>(options)); !fine) return fine;
  return check(static_cast<const CalibrationOptions&>(options));
}

}  // namespace waymark
