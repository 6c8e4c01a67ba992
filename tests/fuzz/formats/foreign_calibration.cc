#include "core/camera/foreign_calibration.h"

#include "core/camera/kalibr.h"
#include "tests/fuzz/format.h"
#include "tests/support/foreign_calibrations.h"

namespace waymark::test {
namespace {

const AddFormat foreign_calibration({"ForeignCalibration",
                                     {kRosCameraInfo, kOpenCvStorage},
                                     {"image_width:",
                                      "image_Width:",
                                      "image_height:",
                                      "camera_matrix:",
                                      "camera_name:",
                                      "projection_matrix:",
                                      "distortion_model:",
                                      "plumb_bob",
                                      "rational_polynomial",
                                      "fisheye",
                                      "equidistant",
                                      "distortion_coefficients:",
                                      "dist_coeffs:",
                                      "data:",
                                      "%YAML:1.0\n",
                                      "!!opencv-matrix",
                                      "&a",
                                      "*a",
                                      ".nan",
                                      ".inf"},
                                     reader([](const std::string& text) {
                                       return parse_camchain(text, "rig.yaml");
                                     })});

}  // namespace
}  // namespace waymark::test
