#pragma once

#include "mapbuilder/growth/mapper_options.h"

namespace waymark {

// How far an adjustment goes at each stage of a map's making. The options must be effective().

/// Of markers just placed against the rest: only so far that what is placed next rests well.
[[nodiscard]] inline BundleOptions fresh_adjustment(const MapperOptions& options) {
  return {.solver = options.solver,
          .max_iterations = 6,
          .function_tolerance = 1e-2,
          .initial_damping = 1e-6,
          .threads = options.threads};
}

/// Of all that has grown so far, whenever it has grown by half.
[[nodiscard]] inline BundleOptions growth_adjustment(const MapperOptions& options) {
  return {.solver = options.solver,
          .max_iterations = 10,
          .function_tolerance = 1e-3,
          .initial_damping = 1e-6,
          .threads = options.threads};
}

/// Between two looks at noise, flips and gate, which may change more than another digit would.
[[nodiscard]] inline BundleOptions pass_adjustment(const MapperOptions& options) {
  return {.solver = options.solver,
          .max_iterations = 30,
          .function_tolerance = 1e-4,
          .initial_damping = 1e-8,
          .threads = options.threads};
}

/// The last one: to the optimum, with next to no damping.
[[nodiscard]] inline BundleOptions polish_adjustment(const MapperOptions& options) {
  return {.solver = options.solver,
          .max_iterations = 50,
          .function_tolerance = 1e-9,
          .initial_damping = 1e-14,
          .threads = options.threads};
}

/// The first one with a survey or a variable calibration: it may lead far.
[[nodiscard]] inline BundleOptions calibration_adjustment(const MapperOptions& options) {
  return {.solver = options.solver,
          .max_iterations = 50,
          .function_tolerance = 1e-7,
          .initial_damping = 1e-6,
          .threads = options.threads};
}

/// Of a trial whether the rig file fits: a few steps tell.
[[nodiscard]] inline BundleOptions trial_adjustment(const MapperOptions& options) {
  return {.solver = options.solver,
          .max_iterations = 4,
          .function_tolerance = 1e-2,
          .initial_damping = 1e-6,
          .threads = options.threads};
}

}  // namespace waymark
