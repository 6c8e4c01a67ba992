#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/camera/camera_model.h"

namespace waymark {

/// What a calib.json says of its one camera: a pinhole with distortion as OpenCV has it.
struct CalibJson {
  double fu_px = 0, fv_px = 0;
  double pu_px = 0, pv_px = 0;
  Distortion distortion = Distortion::radtan;  ///< radtan, radtan5 or rational
  LensCoefficients coefficients{};
  std::optional<std::pair<int, int>> size_px;  ///< width, height, when stated
};

/// Reads calib.json: the intrinsics as camera_matrix or K (3×3, nested or flat, or OpenCV's object
/// with data) or as fx, fy, cx, cy; the distortion as dist or distortion (OpenCV's order,
/// four to eight and zeros; none at all = no distortion); the size as width and height, or as
/// resolution [w h]. bad_data, naming the keys seen, for anything else; no_input when absent.
[[nodiscard]] Expected<CalibJson> read_calib_json(const std::filesystem::path& path);

/// The same from text; `name` stands for the path in messages.
[[nodiscard]] Expected<CalibJson> parse_calib_json(const std::string& text,
                                                   const std::string& name);

}  // namespace waymark
