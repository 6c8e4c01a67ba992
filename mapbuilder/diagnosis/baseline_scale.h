#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "core/camera/rig.h"
#include "mapbuilder/diagnosis/finding.h"

namespace waymark {

/// By how much baselines that fit the images, in the scale of the stated sizes, are longer than
/// those stated.
struct BaselineScale {
  double factor = 1;
  double sigma = 0;  ///< one standard deviation
};

/// Whether one factor on all baselines explains how the fitted rig differs from the stated one: it
/// gains more than `least_gain` (sigmas²) and leaves a quarter at most. `covariance` of the fitted
/// rig_from_cam, six per camera (Rigid3's tangent); what a calibration leaves (1 mm, 0.05°) comes
/// on top. nullopt: another cause, or none.
[[nodiscard]] std::optional<BaselineScale> baseline_scale(const Rig& stated, const Rig& fitted,
                                                          const Eigen::MatrixXd& covariance,
                                                          double least_gain = 20.0);

/// The rig with baselines so many times as long.
[[nodiscard]] Rig with_baselines(Rig rig, double factor);

/// "stated sizes are 3.0 ± 0.1 % too small against the rig's baselines, or the baselines too
/// large".
[[nodiscard]] std::string sizes_against_baselines(const BaselineScale& scale);

/// What to do then: the ruler before the solver.
inline constexpr const char* kMeasureSizes =
    "Measure the outer edge of a marker's black border and correct markers.toml; if it is as "
    "stated, measure the distance between two cameras.";

/// An error, or a warning where it is within what prints and calibrations leave together (5 %).
[[nodiscard]] Finding finding_of(const BaselineScale& scale, const Rig& rig);

}  // namespace waymark
