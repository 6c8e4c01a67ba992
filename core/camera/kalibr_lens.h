#pragma once

#include <string>

#include "core/camera/camera_model.h"
#include "core/camera/kalibr_node.h"

namespace waymark {

/// What a camera's camera_model, intrinsics, distortion_model, distortion_coeffs, resolution and
/// valid_radius_px say. pinhole has distortion_model none, radtan (4 or 5 coefficients), rational
/// (8) or equidistant (4); eucm and ds have none, and alpha beta or xi alpha before fu fv pu pv.
/// Values are not held against their ranges: CameraModel::create does.
[[nodiscard]] Expected<CameraParameters> read_kalibr_lens(const KalibrNode& camera);

/// The same keys' text within a camera's entry, numbers to 17 digits.
[[nodiscard]] std::string format_kalibr_lens(const CameraParameters& parameters);

}  // namespace waymark
