#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "core/camera/camera_model.h"
#include "core/geometry/rigid3.h"
#include "core/marker/marker_geometry.h"
#include "mapbuilder/observations/detected_capture.h"

namespace waymark {

/// The eight numbers of a marker's outline near a pose of its own: what they say of lens and print,
/// no map, rig or size asked, for the pose takes six of them.
struct SquareEquations {
  Eigen::Matrix<double, 8, 1> residual;                 ///< observed less predicted (px)
  Eigen::Matrix<double, 8, 6> by_pose;                  ///< Rigid3's tangent of cam_from_marker
  Eigen::Matrix<double, 8, kIntrinsicNumbers> by_lens;  ///< fu fv pu pv and the coefficients
  Eigen::Matrix<double, 8, 1> by_stretch;  ///< logarithm of the print's width over its height
};

/// Of an outline against a square of 1 m in a pose; nullopt where a corner can't be projected.
[[nodiscard]] std::optional<SquareEquations> linearize_square(const CameraModel& camera,
                                                              const ImageCorners& outline_px,
                                                              const Rigid3& cam_from_marker);

/// The pose in which a square of 1 m fits an outline best; nullopt where it is a view of none.
[[nodiscard]] std::optional<Rigid3> own_pose(const CameraModel& camera,
                                             const ImageCorners& outline_px);

/// Squared misfit (px²) that this pose leaves.
[[nodiscard]] std::optional<double> own_misfit_px2(const CameraModel& camera,
                                                   const ImageCorners& outline_px);

/// What corners are worth per axis (px) by the squared misfits (px²) that outlines' own poses
/// leave: by the median, so that a few wrong outlines have no say; infinite of none.
[[nodiscard]] double own_px_of(std::vector<double> squared);

/// What a camera of a capture has seen where its calibration says something, in the order of its
/// images.
[[nodiscard]] std::vector<ImageCorners> outlines_of(const DetectedCapture& capture,
                                                    std::size_t camera);

/// At most so many, evenly spread.
[[nodiscard]] std::vector<ImageCorners> spread(std::span<const ImageCorners> outlines,
                                               std::size_t most);

}  // namespace waymark
