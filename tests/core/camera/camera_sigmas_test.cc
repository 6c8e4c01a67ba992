#include "core/camera/camera_sigmas.h"

#include <gtest/gtest.h>

#include <numbers>

namespace waymark {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;

TEST(CameraSigmas, SourcesHaveNames) {
  for (const SigmaSource source :
       {SigmaSource::kalibr, SigmaSource::opencv, SigmaSource::hand, SigmaSource::refined}) {
    EXPECT_EQ(sigma_source_from(to_string(source)), source);
  }
  EXPECT_EQ(sigma_source_from("Kalibr"), std::nullopt);
}

TEST(CameraSigmas, DefaultsAreAsDocumented) {
  const CameraSigmas kalibr = default_sigmas(SigmaSource::kalibr, std::nullopt, {});
  EXPECT_EQ(kalibr.position_m, 0.001);
  EXPECT_DOUBLE_EQ(kalibr.rotation_rad, 0.05 * kRadPerDeg);
  EXPECT_EQ(kalibr.focal, 0.001);
  EXPECT_EQ(kalibr.principal_px, 0.5);
  EXPECT_EQ(kalibr.k1, 0.005);
  EXPECT_EQ(kalibr.edge_px, 0.2);
  EXPECT_EQ(kalibr.stamp_s, 1e-3);
  EXPECT_EQ(kalibr.readout_s, 5e-3);
  EXPECT_EQ(default_sigmas(SigmaSource::refined, std::nullopt, {}), kalibr);
  const CameraSigmas opencv = default_sigmas(SigmaSource::opencv, std::nullopt, {});
  EXPECT_EQ(opencv.focal, 0.003);
  EXPECT_EQ(opencv.principal_px, 1.5);
  EXPECT_EQ(opencv.k1, 0.01);
  const CameraSigmas hand = default_sigmas(SigmaSource::hand, std::nullopt, {});
  EXPECT_EQ(hand.position_m, 0.005);
  EXPECT_DOUBLE_EQ(hand.rotation_rad, 0.5 * kRadPerDeg);
  EXPECT_EQ(hand.focal, 0.01);
  EXPECT_EQ(hand.principal_px, 5);
  EXPECT_EQ(hand.k1, 0.05);
}

TEST(CameraSigmas, CircumstancesTell) {
  const CameraSigmas sigmas = default_sigmas(SigmaSource::kalibr, 0.015, {true});
  EXPECT_EQ(sigmas.edge_px, 0.2) << "nothing but images tells how a sensor encodes light";
  EXPECT_EQ(sigmas.stamp_s, 2e-5);
  EXPECT_DOUBLE_EQ(sigmas.readout_s, 3e-4);
  EXPECT_EQ(default_sigmas(SigmaSource::kalibr, 0.0, {}).readout_s, 0);
}

}  // namespace
}  // namespace waymark
