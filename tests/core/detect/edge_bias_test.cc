#include "core/detect/edge_bias.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/edge_trials.h"

namespace waymark {
namespace {

using testing::EdgeTrials;
using testing::measure_edges;
using testing::trial_camera;

/// A marker whose fits found these.
EdgeSample fitted(double linear_px, double srgb_px, double growth_linear = 0,
                  double growth_srgb = -0.2) {
  EdgeSample sample;
  MarkerFit fit;
  fit.blur_px = 0.4;
  fit.growth_sigma = 0.01;
  fit.misfit = 1000;
  fit.inset_px = linear_px;
  fit.growth_px = growth_linear;
  sample.fits.by_response[0] = fit;
  fit.inset_px = srgb_px;
  fit.growth_px = growth_srgb;
  sample.fits.by_response[1] = fit;
  sample.fits.cell_px = 8;
  return sample;
}

TEST(EdgeBias, FewerThanEightMarkersTellNothing) {
  std::vector<EdgeSample> samples(7, fitted(0.1, 0.12));
  EXPECT_FALSE(edge_bias(samples));
  samples.push_back(fitted(0.1, 0.12));
  EXPECT_TRUE(edge_bias(samples));
}

TEST(EdgeBias, ClippedAndSmallMarkersDoNotCount) {
  std::vector<EdgeSample> samples(20, fitted(0.1, 0.12));
  for (EdgeSample& sample : samples) sample.fits.clipped_share = 0.1;
  EXPECT_FALSE(edge_bias(samples));
  for (EdgeSample& sample : samples) sample.fits.clipped_share = 0.09;
  EXPECT_TRUE(edge_bias(samples));
  for (EdgeSample& sample : samples) sample.fits.cell_px = 2.9;
  EXPECT_FALSE(edge_bias(samples));
}

TEST(EdgeBias, WhatNoCameraDoesIsNoBias) {
  // At a blur of 0.4 px up to 0.25 + 0.16 px.
  EXPECT_TRUE(edge_bias(std::vector<EdgeSample>(20, fitted(0.40, 0.40))));
  EXPECT_FALSE(edge_bias(std::vector<EdgeSample>(20, fitted(0.42, 0.42))));
  EXPECT_FALSE(edge_bias(std::vector<EdgeSample>(20, fitted(-0.42, -0.42))));
}

TEST(EdgeBias, FarOnesAreLeftOut) {
  std::vector<EdgeSample> samples;
  samples.reserve(22);
  for (int i = 0; i < 20; ++i) samples.push_back(fitted(0.1 + 0.001 * (i % 5), 0.12));
  const double without = edge_bias(samples, SensorResponse::linear)->inset_px;
  samples.push_back(fitted(0.9, 0.9));
  samples.push_back(fitted(-0.7, -0.7));
  EXPECT_NEAR(edge_bias(samples, SensorResponse::linear)->inset_px, without, 1e-3);
}

TEST(EdgeBias, AStatedResponseIsTaken) {
  const std::vector<EdgeSample> samples(20, fitted(0.1, 0.15));
  EXPECT_NEAR(edge_bias(samples, SensorResponse::linear)->inset_px, 0.1, 1e-9);
  EXPECT_NEAR(edge_bias(samples, SensorResponse::srgb)->inset_px, 0.15, 1e-9);
}

TEST(EdgeBias, AnOpenResponseLiesBetweenAndIsUnsure) {
  const std::vector<EdgeSample> samples(20, fitted(0.1, 0.15, 0.1, -0.1));
  const auto bias = edge_bias(samples);
  EXPECT_FALSE(bias->response);
  EXPECT_NEAR(bias->srgb_share, 0.5, 1e-9);
  EXPECT_NEAR(bias->inset_px, 0.125, 1e-9);
  EXPECT_GT(bias->sigma_px, 0.024);
}

TEST(EdgeBias, OfAnOpenResponseTheOneThatGrowsLessIsMoreProbable) {
  const std::vector<EdgeSample> samples(20, fitted(0.1, 0.15, 0.2, 0.02));
  EXPECT_GT(edge_bias(samples)->srgb_share, 0.8);
}

TEST(EdgeBias, AMarkersOwnCountsByItsVariance) {
  EdgeBias camera;
  camera.inset_px = 0.1;
  camera.scatter_px = 0.0;
  EXPECT_NEAR(inset_of(fitted(0.3, 0.3).fits, camera), 0.1, 1e-3);
  camera.scatter_px = 1.0;
  EXPECT_NEAR(inset_of(fitted(0.3, 0.3).fits, camera), 0.3, 1e-3);
  // Out of reason, or not fitted: the camera's mean.
  EXPECT_EQ(inset_of(fitted(0.7, 0.7).fits, camera), 0.1);
  MarkerFits none;
  EXPECT_EQ(inset_of(none, camera), 0.1);
  // A clipped one counts though the camera's others scatter little.
  camera.scatter_px = 0;
  MarkerFits clipped = fitted(0.3, 0.3).fits;
  clipped.clipped_share = 0.2;
  EXPECT_NEAR(inset_of(clipped, camera), 0.3, 0.005);
}

/// A camera as it may come.
struct Camera {
  const char* name;
  bool srgb;
  double psf_px;
  double noise_grey;
  Distortion lens = Distortion::none;
};

class SimulatedEdges : public ::testing::TestWithParam<Camera> {};

TEST_P(SimulatedEdges, AreMeasuredWithinTheStatedSigma) {
  EdgeTrials trials;
  trials.images = 14;
  trials.image.srgb = GetParam().srgb;
  trials.image.psf_sigma_px = GetParam().psf_px;
  trials.image.noise_grey = GetParam().noise_grey;
  const auto edges = measure_edges(trial_camera(GetParam().lens), trials);
  ASSERT_TRUE(edges.measured);
  EXPECT_LT(std::abs(edges.measured->inset_px - edges.true_inset_px), 3 * edges.measured->sigma_px);
  EXPECT_LT(edges.measured->sigma_px, 0.04);
  EXPECT_LT(std::abs(edges.corrected_px), std::max(0.02, 0.4 * std::abs(edges.true_inset_px)));
  if (edges.measured->response) {
    EXPECT_EQ(*edges.measured->response,
              GetParam().srgb ? SensorResponse::srgb : SensorResponse::linear);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Cameras, SimulatedEdges,
    ::testing::Values(Camera{"SharpLinear", false, 0.3, 1.5}, Camera{"SharpSrgb", true, 0.3, 1.5},
                      Camera{"Linear", false, 0.7, 1.5}, Camera{"Srgb", true, 0.7, 1.5},
                      Camera{"NoisyLinear", false, 0.7, 4}, Camera{"NoisySrgb", true, 0.7, 4},
                      Camera{"SoftLinear", false, 1.2, 1}, Camera{"SoftSrgb", true, 1.2, 1},
                      Camera{"FisheyeSrgb", true, 0.7, 1.5, Distortion::equidistant}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace waymark
