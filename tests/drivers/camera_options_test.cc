#include "drivers/camera_options.h"

#include <gtest/gtest.h>

#include "tests/support/expect_ranges.h"

namespace waymark {
namespace {

TEST(CameraOptions, AreHeldToTheirRanges) {
  using Options = CameraOptions;
  using Controls = CameraControls;
  expect_ranges<Options>(
      {{"request.fps", CaptureRequest::kFps, [](Options& o, double v) { o.request.fps = v; }},
       {"controls.gain", Controls::kGain, [](Options& o, double v) { o.controls.gain = v; }},
       ranged("readout in us", &Options::readout, RigCamera::kReadout_us, 1)});
}

TEST(CameraControls, AreHeldToTheirRangesWhereTheyAreThere) {
  using Controls = CameraControls;
  expect_ranges<Controls>(
      {{"exposure_us", Controls::kExposure_us, [](Controls& c, double v) { c.exposure_us = v; }},
       {"gain", Controls::kGain, [](Controls& c, double v) { c.gain = v; }},
       {"white_balance_k", Controls::kWhiteBalance_k,
        [](Controls& c, double v) { c.white_balance_k = v; }},
       {"focus", Controls::kFocus, [](Controls& c, double v) { c.focus = v; }}});
}

TEST(CameraControls, KnowThreeFrequenciesOfMains) {
  for (const int hz : {0, 50, 60}) EXPECT_TRUE(CameraControls{.power_line_hz = hz}.check()) << hz;
  for (const int hz : {-1, 49, 51, 400}) {
    EXPECT_FALSE(CameraControls{.power_line_hz = hz}.check()) << hz;
  }
}

}  // namespace
}  // namespace waymark
