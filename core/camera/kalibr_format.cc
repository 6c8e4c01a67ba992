#include <yaml-cpp/yaml.h>

#include <Eigen/Geometry>
#include <string>

#include "core/camera/kalibr.h"
#include "core/camera/kalibr_lens.h"
#include "core/camera/kalibr_sigmas.h"

namespace waymark {
namespace {

std::string format_rows(const Rigid3& t) {
  Eigen::Matrix<double, 3, 4> m;
  m << t.rotation.toRotationMatrix(), t.translation;
  std::string text;
  for (int row = 0; row < 3; ++row) {
    text += fmt::format("  - [{:.17g}, {:.17g}, {:.17g}, {:.17g}]\n", m(row, 0), m(row, 1),
                        m(row, 2), m(row, 3));
  }
  return text + "  - [0, 0, 0, 1]\n";
}

/// A YAML scalar in double quotes.
std::string quoted(const std::string& text) {
  YAML::Emitter emitter;
  emitter << YAML::DoubleQuoted << text;
  return emitter.c_str();
}

std::string format_camera(const RigCamera& camera) {
  std::string text =
      fmt::format("{}:\n", camera.name) + format_kalibr_lens(camera.model.parameters());
  if (!camera.serial.empty()) text += fmt::format("  serial: {}\n", quoted(camera.serial));
  if (!camera.lens_id.empty()) text += fmt::format("  lens_id: {}\n", quoted(camera.lens_id));
  if (camera.readout_us) text += fmt::format("  readout_us: {:.17g}\n", *camera.readout_us);
  if (camera.edge_bias_px) text += fmt::format("  edge_bias_px: {:.17g}\n", *camera.edge_bias_px);
  if (camera.response) text += fmt::format("  response: {}\n", to_string(*camera.response));
  if (camera.global_shutter) text += fmt::format("  global_shutter: {}\n", *camera.global_shutter);
  if (camera.timeshift_cam_imu_s) {
    text += fmt::format("  timeshift_cam_imu: {:.17g}\n", *camera.timeshift_cam_imu_s);
  }
  return text;
}

}  // namespace

std::string format_camchain(const Rig& rig) {
  if (rig.cameras.empty()) return {};
  // cam0 at the rig's origin is Kalibr's camchain; elsewhere, its camchain-imucam.
  const Rigid3& first = rig.cameras.front().rig_from_cam;
  const bool rig_is_cam0 = first.translation.isZero(0) && first.rotation.vec().isZero(0);
  std::string text;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    const RigCamera& camera = rig.cameras[i];
    text += format_camera(camera) + format_kalibr_sigmas(rig, i);
    if (!rig.has_extrinsics) continue;
    const Rigid3 cam_from_rig = camera.rig_from_cam.inverse();
    if (!rig_is_cam0) text += "  T_cam_imu:\n" + format_rows(cam_from_rig);
    if (i > 0) {
      text += "  T_cn_cnm1:\n" + format_rows(cam_from_rig * rig.cameras[i - 1].rig_from_cam);
    }
  }
  return text;
}

}  // namespace waymark
