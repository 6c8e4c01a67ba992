#include "mapbuilder/diagnosis/lens_of_squares.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/mapbuilder/diagnosis/seen_squares.h"

namespace waymark {
namespace {

using tests::seen_squares;

struct Camera {
  const char* name;
  CameraParameters parameters;
};

CameraParameters camera(int width, int height, double focal, Distortion distortion,
                        const LensCoefficients& coefficients) {
  CameraParameters p;
  p.width_px = width;
  p.height_px = height;
  p.fu_px = focal;
  p.fv_px = 1.003 * focal;
  p.pu_px = 0.51 * width;
  p.pv_px = 0.485 * height;
  p.distortion = distortion;
  p.coefficients = coefficients;
  return p;
}

const Camera kCameras[] = {
    {"webcam", camera(1280, 720, 905, Distortion::radtan, {-0.21, 0.08, 0.001, -0.0005})},
    {"wide", camera(1280, 960, 640, Distortion::none, {})},
    {"tele", camera(1600, 1200, 2400, Distortion::radtan, {-0.1, 0.02, 0, 0})},
    {"fisheye", camera(1024, 1024, 330, Distortion::equidistant, {0.02, -0.01, 0.003, 0})},
};

/// Ways to state another camera than that which took the images.
struct Fault {
  const char* name;
  void (*apply)(CameraParameters&);
};

void scale_focal(CameraParameters& p, double factor) {
  p.fu_px *= factor;
  p.fv_px *= factor;
}
void scale_all(CameraParameters& p, double factor) {
  scale_focal(p, factor);
  p.pu_px = (p.pu_px + 0.5) * factor - 0.5;
  p.pv_px = (p.pv_px + 0.5) * factor - 0.5;
}

const Fault kFaults[] = {
    {"as it is", [](CameraParameters&) {}},
    {"half", [](CameraParameters& p) { scale_all(p, 0.5); }},
    {"double", [](CameraParameters& p) { scale_all(p, 2); }},
    {"a third", [](CameraParameters& p) { scale_all(p, 1 / 3.0); }},
    {"f + 30 %", [](CameraParameters& p) { scale_focal(p, 1.3); }},
    {"f - 18 %", [](CameraParameters& p) { scale_focal(p, 0.82); }},
    {"f + 70 %", [](CameraParameters& p) { scale_focal(p, 1.7); }},
    {"straight", [](CameraParameters& p) { p.coefficients = {}; }},
    {"squeezed", [](CameraParameters& p) { p.fv_px *= 0.75; }},
    {"cropped", [](CameraParameters& p) { p.pu_px += 0.1 * p.width_px; }},
};

TEST(LensOfSquares, SquaresTellTheCameraWhateverIsStated) {
  for (const Camera& kind : kCameras) {
    const CameraModel truth = *CameraModel::create(kind.parameters);
    for (const unsigned seed : {1U, 2U}) {
      const auto squares = seen_squares(truth, 200, 0.15, seed);
      for (const Fault& fault : kFaults) {
        SCOPED_TRACE(testing::Message() << kind.name << ", " << fault.name << ", seed " << seed);
        CameraParameters stated = kind.parameters;
        fault.apply(stated);
        const auto found = lens_of_squares(stated, squares);
        ASSERT_TRUE(found);
        EXPECT_NEAR(found->own_px, 0.15, 0.03);
        EXPECT_NEAR(found->parameters.fu_px / kind.parameters.fu_px, 1, 0.04);
        EXPECT_NEAR(found->parameters.fv_px / kind.parameters.fv_px, 1, 0.04);
      }
    }
  }
}

TEST(LensOfSquares, AFewWrongOutlinesHaveNoSay) {
  const CameraModel truth = *CameraModel::create(kCameras[0].parameters);
  auto squares = seen_squares(truth, 250, 0.15, 3);
  for (std::size_t i = 0; i < squares.size(); i += 12) squares[i][1] += Eigen::Vector2d(9, -6);
  CameraParameters stated = kCameras[0].parameters;
  scale_focal(stated, 1.4);
  const auto found = lens_of_squares(stated, squares);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->parameters.fu_px / kCameras[0].parameters.fu_px, 1, 0.04);
}

TEST(LensOfSquares, TooFewTellNothing) {
  const CameraModel truth = *CameraModel::create(kCameras[0].parameters);
  EXPECT_FALSE(lens_of_squares(kCameras[0].parameters, seen_squares(truth, 19, 0.15, 1)));
  EXPECT_TRUE(std::isinf(own_misfit_px(truth, {})));
}

TEST(LensOfSquares, AWrongLensSpoilsMarkersOwnPoses) {
  const CameraModel truth = *CameraModel::create(kCameras[0].parameters);
  const auto squares = seen_squares(truth, 250, 0.1, 1);
  EXPECT_NEAR(own_misfit_px(truth, squares), 0.1, 0.02);
  CameraParameters stated = kCameras[0].parameters;
  scale_focal(stated, 0.5);
  EXPECT_GT(own_misfit_px(*CameraModel::create(stated), squares), 0.3);
}

}  // namespace
}  // namespace waymark
