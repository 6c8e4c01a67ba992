#include "simulator/rig_library.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <span>

#include "core/base/check.h"
#include "core/base/is_there.h"
#include "core/camera/kalibr.h"

namespace waymark::simulator {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

// The paper's camera (§III-A, Fig. 2).
constexpr int kWidth_px = 1224;
constexpr int kHeight_px = 1024;
constexpr double kHorizontalFov_deg = 39.56;
constexpr double kVerticalFov_deg = 33.49;

/// Distance of each camera's centre from the rig's vertical axis.
constexpr double kRadius_m = 0.10;

/// Three lenses of one kind are never the same: principal point's offset from the centre (px) and
/// radtan coefficients as Kalibr finds them for 8 mm machine-vision lenses.
struct Lens {
  double du_px, dv_px;
  LensCoefficients radtan;
};
constexpr std::array<Lens, 3> kLenses = {{{6.3, -4.1, {-0.102, 0.145, 0.0004, -0.0006}},
                                          {-8.7, 3.6, {-0.097, 0.118, -0.0005, 0.0003}},
                                          {2.2, 7.9, {-0.108, 0.163, 0.0002, 0.0007}}}};

CameraModel camera_with(const Lens& lens) {
  CameraParameters parameters;
  parameters.width_px = kWidth_px;
  parameters.height_px = kHeight_px;
  parameters.fu_px = 0.5 * kWidth_px / std::tan(0.5 * kHorizontalFov_deg * kRadPerDeg);
  parameters.fv_px = 0.5 * kHeight_px / std::tan(0.5 * kVerticalFov_deg * kRadPerDeg);
  parameters.pu_px = 0.5 * (kWidth_px - 1) + lens.du_px;
  parameters.pv_px = 0.5 * (kHeight_px - 1) + lens.dv_px;
  parameters.distortion = Distortion::radtan;
  parameters.coefficients = lens.radtan;
  auto model = CameraModel::create(parameters);
  WAYMARK_CHECK(model.has_value());
  return *model;
}

/// Pose of a camera that looks `yaw_deg` to the left of the rig's forward direction, in a frame
/// with x forward, y left, z up on the rig's axis.
Rigid3 axis_from_camera(double yaw_deg) {
  const double yaw_rad = yaw_deg * kRadPerDeg;
  const Eigen::Vector3d forward(std::cos(yaw_rad), std::sin(yaw_rad), 0);
  const Eigen::Vector3d right(std::sin(yaw_rad), -std::cos(yaw_rad), 0);
  Eigen::Matrix3d axes;
  axes << right, -Eigen::Vector3d::UnitZ(), forward;
  return {Eigen::Quaterniond(axes), kRadius_m * forward};
}

Rig rig_looking(std::span<const double> yaws_deg) {
  Rig rig;
  const Rigid3 cam0_from_axis = axis_from_camera(yaws_deg[0]).inverse();
  for (std::size_t i = 0; i < yaws_deg.size(); ++i) {
    rig.cameras.push_back({.name = fmt::format("cam{}", i),
                           .model = camera_with(kLenses[i % kLenses.size()]),
                           .rig_from_cam = cam0_from_axis * axis_from_camera(yaws_deg[i]),
                           .serial = "",
                           .lens_id = "",
                           .readout_us = std::nullopt,
                           .global_shutter = std::nullopt,
                           .timeshift_cam_imu_s = std::nullopt});
  }
  return rig;
}

}  // namespace

Expected<SimulatedRig> load_rig(const std::string& name_or_file) {
  constexpr std::array kSixty = {0.0, 60.0, -60.0};
  constexpr std::array kHundredTwenty = {0.0, 120.0, -120.0};
  constexpr std::array kBackToBack = {0.0, 180.0};
  if (name_or_file == "cg60") return SimulatedRig{name_or_file, rig_looking(kSixty), false};
  if (name_or_file == "cg120")
    return SimulatedRig{name_or_file, rig_looking(kHundredTwenty), false};
  if (name_or_file == "cg180") return SimulatedRig{name_or_file, rig_looking(kBackToBack), false};
  if (name_or_file == "mono") return SimulatedRig{name_or_file, rig_looking(kHundredTwenty), true};
  if (!is_there(name_or_file)) {
    return fail(ErrorKind::no_input,
                "rig \"{}\": neither a built-in rig (mono cg60 cg120 cg180) nor a camchain file",
                name_or_file);
  }
  auto loaded = read_camchain(name_or_file);
  if (!loaded) return tl::make_unexpected(loaded.error());
  if (loaded->rig.cameras.empty()) {
    return fail(ErrorKind::bad_data, "{}: a rig without cameras", name_or_file);
  }
  if (!loaded->rig.has_extrinsics) {
    return fail(ErrorKind::bad_data,
                "{}: several cameras without transforms can't be mounted; add T_cn_cnm1",
                name_or_file);
  }
  return SimulatedRig{std::filesystem::path(name_or_file).stem().string(), std::move(loaded->rig),
                      false};
}

}  // namespace waymark::simulator
