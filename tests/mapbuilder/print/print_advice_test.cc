#include "mapbuilder/print/print_advice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace waymark {
namespace {

Rig rig_of(double focal_px) {
  CameraParameters parameters;
  parameters.width_px = 1201;
  parameters.height_px = 1001;
  parameters.fu_px = parameters.fv_px = focal_px;
  parameters.pu_px = 600;
  parameters.pv_px = 500;
  Rig rig;
  rig.cameras.push_back({"cam0", *CameraModel::create(parameters), {}, {}, {}, {}, {}, {}});
  return rig;
}

TEST(PrintAdvice, ASizeHasFourPixelsACellAtTheRange) {
  const PrintAdvice advice = print_advice(rig_of(600), 6).front();
  // Eight cells of four pixels at 45°: 32 · 6 / (600 · 0.707) = 0.4525 m, rounded up.
  EXPECT_NEAR(advice.size_m, 0.46, 1e-9);
  EXPECT_NEAR(advice.readable_m, 0.46 * 600 / 32, 1e-9);
  EXPECT_NEAR(advice.field_rad, std::numbers::pi / 2, 1e-9);
  // Half the range: a field of 6 m, of which a quarter.
  EXPECT_NEAR(advice.spacing_m, 1.5, 1e-9);
}

TEST(PrintAdvice, LongerLensesNeedSmallerMarkers) {
  EXPECT_LT(print_advice(rig_of(1200), 6).front().size_m,
            print_advice(rig_of(600), 6).front().size_m);
}

TEST(PrintAdvice, TheLargestSizeServesAllCameras) {
  Rig rig = rig_of(600);
  rig.cameras.push_back(rig_of(1200).cameras.front());
  const std::string text = advice_text(print_advice(rig, 6), 6);
  EXPECT_NE(text.find("print: --size-m 0.46"), std::string::npos) << text;
}

}  // namespace
}  // namespace waymark
