#pragma once

#include <Eigen/Core>

#include "core/camera/rig.h"
#include "mapbuilder/calibration/calibration_options.h"

namespace waymark {

/// The rig with how sure its calibration is of it: sigma, sigma_joint and sigma_source: refined.
/// `joint` is CalibrationUncertainty's, of these cameras alone: fu and fv together are the focal
/// length's share, of the lens the first coefficient that bends is stated. What was not calibrated
/// (edges, stamps, read-out, a number that was constant) keeps what it had, or its default. `held`:
/// some direction could not be told and stays where it was; then every number is known to the
/// limits at best, which the directions that can be told were judged by.
[[nodiscard]] Rig with_posterior_sigmas(Rig rig, const Eigen::MatrixXd& joint, bool held,
                                        const RefinementLimits& limits);

/// How far two calibrations of a rig by different images are apart, against what both state: the
/// mean over their calibrated numbers of the squared difference over the sum of the variances. 1 is
/// what sigmas promise. Both are with_posterior_sigmas.
[[nodiscard]] double squared_sigmas_apart(const Rig& one, const Rig& other);

/// The rig with its stated sigmas, and the calibrated numbers' part of the joint ones, times
/// `factor`.
[[nodiscard]] Rig with_sigmas_times(Rig rig, double factor);

}  // namespace waymark
