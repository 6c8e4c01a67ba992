#pragma once

#include <optional>
#include <span>
#include <vector>

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

/// The views that the gate accepts at that place, printed so; none where they are fewer than three
/// in four: a marker that stands in two places, or shows something else, can pass for one of odd
/// size or shape.
[[nodiscard]] std::vector<MarkerView> views_that_fit(std::vector<MarkerView> views,
                                                     const PrintedPose& place,
                                                     const MapEvidence& evidence);

/// When a print counts as of another size than stated, or as not square.
struct OddPrintOptions {
  /// (3–20) Deviation from what all other markers show, in sigmas of the fit and of their spread
  /// together: with hundreds of markers and tails that are wider than Gaussian, 6 names no sound
  /// one.
  double least_sigmas = 6.0;
  /// (0.005–0.2, of the size) Below, print and calibration are to blame as well: refinement's job.
  double least_size_deviation = 0.03;
  /// (0.005–0.2, logarithm of width over height) Below, paper and lens are to blame as well.
  double least_stretch = 0.02;
  /// (3–50) Views that tell a print; fewer can't contradict each other.
  int least_views = 3;
  /// (3–50) Other markers that tell the spread; among fewer nobody knows who is wrong.
  int least_markers = 5;

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

}  // namespace waymark
