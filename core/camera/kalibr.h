#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/camera/rig.h"

namespace waymark {

/// A rig with what the reader has to tell the user about it (projected rotations, unused keys such
/// as timeshift_cam_imu).
struct LoadedRig {
  Rig rig;
  std::vector<std::string> notes;
};

/// No camera is further from its neighbour, and no vehicle's base from its rig; a larger number is
/// one in mm.
inline constexpr double kMaxBaseline_m = 100.0;

/// Larger is no rig.yaml: 200 cameras take 120 kB. What the parser makes of it is bounded besides
/// (yaml_text.h).
inline constexpr std::size_t kMaxCamchainBytes = std::size_t{192} << 10;

/// Reads a Kalibr camchain (rig.yaml). cam0…camN without gaps; T_cn_cnm1 is camera n from camera
/// n−1. With T_cam_imu on every camera the body is the rig frame and the chain (where present) must
/// agree to 1 mm / 0.1°; on none, cam0 is the rig frame; on some: bad_data. |RᵀR − I| ≤ 1e-3
/// (largest element) is projected to a rotation with a note, beyond: bad_data. Several cameras
/// without any transform: has_extrinsics is false. Extras: serial, lens_id, readout_us,
/// global_shutter, valid_radius_px; sigma, sigma_source, sigma_joint (kalibr_sigmas.h). Errors:
/// no_input, bad_data with file, camera and key.
[[nodiscard]] Expected<LoadedRig> read_camchain(const std::filesystem::path& path);

/// The same from text; `name` stands for the path in messages.
[[nodiscard]] Expected<LoadedRig> parse_camchain(const std::string& text, const std::string& name);

/// Text of a camchain that read_camchain reads back to the same rig (numbers to 17 digits).
[[nodiscard]] std::string format_camchain(const Rig& rig);

}  // namespace waymark
