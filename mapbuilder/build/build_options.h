#pragma once

#include "mapbuilder/calibration/calibration_options.h"
#include "mapbuilder/growth/mapper_options.h"

namespace waymark {

/// Options of a build: those of the mapper and those of the calibration. Defaults are what
/// `mapbuilder build` uses.
struct BuildOptions : MapperOptions, CalibrationOptions {
  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const {
    if (auto fine = MapperOptions::check(); !fine) return fine;
    return CalibrationOptions::check();
  }
};

}  // namespace waymark
