#pragma once

#include <optional>
#include <span>

#include "mapbuilder/diagnosis/map_evidence.h"

namespace waymark {

/// A marker's pose with what its print may have come to.
struct PrintedPose {
  Rigid3 world_from_marker;
  double factor = 1.0;   ///< its size (√(width · height)) over the observations' stated one
  double stretch = 0.0;  ///< logarithm of width over height
};

/// What of the print is free besides the pose.
enum class FreePrint : char { size, size_and_stretch };

/// A marker's pose and print by views whose cameras are known.
struct PrintFit {
  PrintedPose place;
  /// One standard deviation of the factor (relative) and of the stretch; they grow with the misfit
  /// of the views.
  double factor_sigma = 0.0;
  double stretch_sigma = 0.0;  ///< 0 where it was held
  double cost = 0.0;           ///< Σ ρ, sigmas²
};

/// Seven or eight freedoms by Levenberg–Marquardt with the cameras held. nullopt when the start
/// can't be projected or the print is not observable (all views from one spot leave it as sigma,
/// not as nullopt).
[[nodiscard]] std::optional<PrintFit> fit_print(std::span<const MarkerView> views,
                                                const PrintedPose& start, FreePrint free,
                                                const ObservationLoss& loss);

/// Σ of the squared whitened residuals of a view at that place, printed so, sigmas²; infinite where
/// it can't be projected.
[[nodiscard]] double misfit_sigmas2(const MarkerView& view, const PrintedPose& place);

}  // namespace waymark
