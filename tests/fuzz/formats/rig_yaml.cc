#include "core/camera/kalibr.h"
#include "tests/fuzz/format.h"
#include "tests/support/tiny_capture.h"

namespace waymark::test {
namespace {

const char* const kOnBody =
    "cam0:\n  camera_model: pinhole\n  intrinsics: [470.3, 470.5, 639.7, 524.4]\n"
    "  distortion_model: equidistant\n  distortion_coeffs: [-0.0132, -0.0099, 0.0121, -0.0045]\n"
    "  resolution: [1280, 1024]\n  serial: \"0042\"\n  readout_us: 12000.5\n"
    "  global_shutter: false\n  timeshift_cam_imu: 0.002\n  rostopic: /cam/image_raw\n"
    "  T_cam_imu: &t\n  - [0, 0, 1, 0.1]\n  - [0, 1, 0, 0]\n  - [-1, 0, 0, 0]\n"
    "  - [0, 0, 0, 1]\ncam1: {camera_model: pinhole, intrinsics: [60, 60, 31.5, 23.5],\n"
    "  distortion_model: radtan, distortion_coeffs: [0.1, 0, 0, 0], resolution: [64, 48],\n"
    "  T_cam_imu: *t}\n";

const AddFormat rig_yaml({"Camchain",
                          {tiny_rig_yaml(3), kOnBody},
                          {"cam0:",
                           "cam1:",
                           "camera_model:",
                           "pinhole",
                           "intrinsics:",
                           "distortion_model:",
                           "radtan",
                           "equidistant",
                           "none",
                           "distortion_coeffs:",
                           "resolution:",
                           "T_cn_cnm1:",
                           "T_cam_imu:",
                           "serial:",
                           "readout_us:",
                           "global_shutter:",
                           "timeshift_cam_imu:",
                           "&a",
                           "*a",
                           "<<:",
                           "!!",
                           "? ",
                           "- ",
                           ".nan",
                           ".inf",
                           "|\n",
                           ">\n",
                           "---\n",
                           "...\n"},
                          reader([](const std::string& text) {
                            return parse_camchain(text, "rig.yaml");
                          })});

}  // namespace
}  // namespace waymark::test
