#include "mapbuilder/observations/edge_correction.h"

#include <gtest/gtest.h>

#include "core/camera/kalibr.h"
#include "core/capture/image_file.h"
#include "core/marker/marker_outline.h"
#include "mapbuilder/observations/detect_capture.h"
#include "tests/support/marker_scene.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

Rig open_rig() { return parse_camchain(scene_rig_yaml(), "rig.yaml")->rig; }

/// A capture of the scene by a camera that encodes as sRGB.
class EdgeCorrection : public ::testing::Test {
 protected:
  void take(int images) {
    folder_.write("rig.yaml", scene_rig_yaml());
    folder_.write("markers.toml", scene_markers_toml());
    std::filesystem::create_directory(folder_.path() / "cam0");
    testing::RenderOptions options;
    options.srgb = true;
    options.noise_grey = 1;
    for (int i = 0; i < images; ++i) {
      const auto path = folder_.path() / "cam0" / (std::to_string(10 + i) + ".pgm");
      ASSERT_TRUE(write_gray_image(path, scene_image(i, options).view()));
    }
  }

  DetectedCapture detect(bool correct_edges, int threads = 2) {
    const auto capture = open_capture_folder(folder_.path());
    report_ = {};
    auto detected = detect_capture(
        *capture, {.redetect = true, .threads = threads, .correct_edges = correct_edges}, progress_,
        report_);
    EXPECT_TRUE(detected);
    return *detected;
  }

  static double side_px(const Detection& detection) {
    return (detection.corners[1] - detection.corners[0]).norm();
  }

  TemporaryFolder folder_;
  Progress progress_{false};
  DetectionReport report_;
};

TEST_F(EdgeCorrection, TakesGammaOffEverySide) {
  take(8);
  const DetectedCapture plain = detect(false);
  EXPECT_TRUE(report_.edges.empty());
  const DetectedCapture corrected = detect(true);
  ASSERT_EQ(report_.edges.size(), 1U);
  ASSERT_TRUE(report_.edges[0]);
  // At a point spread of 0.8 px gamma moves every edge by a quarter of a pixel.
  EXPECT_NEAR(report_.edges[0]->inset_px, 0.25, 0.03);
  ASSERT_TRUE(corrected.edges.at(0));
  EXPECT_EQ(corrected.edges[0]->bias_px, report_.edges[0]->inset_px);
  for (std::size_t i = 0; i < plain.images.size(); ++i) {
    for (std::size_t k = 0; k < plain.images[i].detections.size(); ++k) {
      EXPECT_NEAR(
          side_px(corrected.images[i].detections[k]) - side_px(plain.images[i].detections[k]),
          2 * 0.25, 0.12);
    }
  }
}

TEST_F(EdgeCorrection, WhatTheRigFileStatesIsTakenAndNotMeasured) {
  take(8);
  const DetectedCapture plain = detect(false);
  std::string stated_rig = scene_rig_yaml();
  stated_rig += "  edge_bias_px: 0.2\n";
  folder_.write("rig.yaml", stated_rig);
  const DetectedCapture stated = detect(true);
  EXPECT_FALSE(report_.edges.at(0));
  EXPECT_FALSE(stated.edges.at(0));
  EXPECT_NEAR(
      inset_px(plain.images[0].detections[0].corners, stated.images[0].detections[0].corners), 0.2,
      1e-3);
}

TEST(StatedEdges, AreABiasOrASigmaBelowWhatImagesTell) {
  RigCamera camera = open_rig().cameras[0];
  EXPECT_FALSE(states_edges(camera));
  camera.edge_bias_px = 0;
  EXPECT_TRUE(states_edges(camera));
  camera.edge_bias_px.reset();
  camera.stated_sigmas.edge_px = 0.0051;
  EXPECT_FALSE(states_edges(camera));
  camera.stated_sigmas.edge_px = 0.0049;
  EXPECT_TRUE(states_edges(camera));
}

TEST_F(EdgeCorrection, ThreadsChangeNothing) {
  take(6);
  const DetectedCapture one = detect(true, 1);
  const DetectedCapture three = detect(true, 3);
  for (std::size_t i = 0; i < one.images.size(); ++i) {
    for (std::size_t k = 0; k < one.images[i].detections.size(); ++k) {
      EXPECT_EQ(one.images[i].detections[k].corners, three.images[i].detections[k].corners);
    }
  }
}

TEST_F(EdgeCorrection, TooFewMarkersLeaveCornersAsTheyAre) {
  take(3);
  const DetectedCapture plain = detect(false);
  const DetectedCapture corrected = detect(true);
  ASSERT_EQ(report_.edges.size(), 1U);
  EXPECT_FALSE(report_.edges[0]);
  EXPECT_EQ(plain.images[0].detections[0].corners, corrected.images[0].detections[0].corners);
  EXPECT_NE(edges_text("cam0", report_.edges[0]).find("fewer than eight clear ones"),
            std::string::npos);
}

TEST(EdgesText, GivesFigureSigmaAndResponse) {
  EdgeBias bias;
  bias.inset_px = 0.268;
  bias.sigma_px = 0.009;
  bias.markers = 68;
  bias.response = SensorResponse::srgb;
  EXPECT_EQ(
      edges_text("cam0", bias),
      "cam0: edges +0.268 ± 0.009 px inside the black, corrected (68 markers, srgb response)");
  bias.response.reset();
  bias.srgb_share = 0.72;
  EXPECT_NE(edges_text("cam0", bias).find("response not told, sRGB by 72 %"), std::string::npos);
}

}  // namespace
}  // namespace waymark
