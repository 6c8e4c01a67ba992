#include "mapbuilder/diagnosis/calibration_findings.h"

#include <gtest/gtest.h>

#include <string>

namespace waymark {
namespace {

RigCamera camera_with(Distortion distortion, double k1, double fu_px = 400) {
  CameraParameters parameters;
  parameters.width_px = 640;
  parameters.height_px = 480;
  parameters.fu_px = parameters.fv_px = fu_px;
  parameters.pu_px = 319.5;
  parameters.pv_px = 239.5;
  parameters.distortion = distortion;
  parameters.coefficients[0] = k1;
  return {"cam0", *CameraModel::create(parameters), {}, {}, {}, {}, {}, {}};
}

/// One camera that is stated without a lens and fits one of k1 = 0.1, surely; its markers lie
/// around a pixel.
struct BentLens {
  explicit BentLens(const Eigen::Vector2d& seen_px) {
    calibration().rigs_before.push_back({{camera_with(Distortion::radtan, 0)}});
    calibration().rigs_fitted.push_back({{camera_with(Distortion::radtan, 0.1)}});
    calibration().intrinsics_cost_ratio = 0.1;
    calibration().uncertainty.cameras.push_back({});
    calibration().uncertainty.joint = 1e-6 * Eigen::MatrixXd::Identity(18, 18);
    Observation seen;
    seen.camera = CameraIndex(0);
    for (Eigen::Vector2d& corner : seen.corners_px) corner = seen_px;
    observations.all.push_back(seen);
    BuiltSubMap submap;
    submap.residuals.push_back({ObservationIndex(0), true, {}});
    result.submaps.push_back(submap);
  }

  CalibrationResult& calibration() { return result.calibration; }
  [[nodiscard]] std::vector<Finding> findings() const {
    return calibration_findings(result, observations, {});
  }

  BuildResult result;
  Observations observations;
};

TEST(CalibrationFindings, ALensIsJudgedWhereMarkersWereSeenOnly) {
  // In the image's corner the two lenses are 40 px apart, near its middle nothing.
  EXPECT_TRUE(BentLens({330, 250}).findings().empty());
  const auto found = BentLens({600, 450}).findings();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].cause, Cause::intrinsics);
  EXPECT_EQ(found[0].subject, "cam0");
  EXPECT_NE(found[0].text.find("the stated zero distortion is wrong"), std::string::npos);
}

TEST(CalibrationFindings, ALensThatSawNoMarkerIsNotJudged) {
  BentLens build({600, 450});
  build.result.submaps[0].residuals.clear();
  EXPECT_TRUE(build.findings().empty());
  build = BentLens({600, 450});
  build.result.submaps[0].residuals[0].accepted = false;
  EXPECT_TRUE(build.findings().empty());
}

TEST(CalibrationFindings, WhatIsHardlyKnownIsNotNamed) {
  BentLens build({600, 450});
  build.calibration().uncertainty.joint *= 1e6;
  EXPECT_TRUE(build.findings().empty());
  build.calibration().uncertainty.joint.resize(0, 0);
  EXPECT_TRUE(build.findings().empty());
}

TEST(CalibrationFindings, WhatExplainsTooLittleIsNotNamed) {
  BentLens build({600, 450});
  build.calibration().intrinsics_cost_ratio = 0.99;
  EXPECT_TRUE(build.findings().empty());
}

TEST(CalibrationFindings, ASurveyEntryIsNamedBeyondFiveOfItsSigmas) {
  BuildResult result;
  BuiltSubMap submap;
  SurveyResidual entry;
  entry.entry = "3 center – 7 center";
  entry.mapped = true;
  entry.sigma_m = 0.001;
  entry.residual_m = 0.0049;
  submap.survey = {entry};
  result.submaps = {submap};
  EXPECT_TRUE(calibration_findings(result, {}, {}).empty());
  result.submaps[0].survey[0].residual_m = -0.0051;
  const auto found = calibration_findings(result, {}, {});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].cause, Cause::survey_entry);
  EXPECT_EQ(found[0].text,
            "disagrees with the map: off by -5.1 mm, 5.1 times its stated sigma of 1.0 mm.");
  result.submaps[0].survey[0].use = SurveyUse::left_out;
  EXPECT_TRUE(calibration_findings(result, {}, {}).empty());
}

}  // namespace
}  // namespace waymark
