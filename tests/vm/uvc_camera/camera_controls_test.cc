#include "tests/vm/uvc_camera/camera_controls.h"

#include <gtest/gtest.h>

namespace waymark::uvc {
namespace {

constexpr std::uint16_t kExposureSelector = 0x0400;
constexpr std::uint16_t kCameraEntity = 0x0100;
constexpr std::uint16_t kGainSelector = 0x0400;
constexpr std::uint16_t kProcessingEntity = 0x0200;

std::optional<Bytes> ask(CameraControls& controls, std::uint8_t request, std::uint16_t selector,
                         std::uint16_t entity, Bytes data = {}) {
  const auto type = static_cast<std::uint8_t>(request == kSetCurrent ? 0x21 : 0xA1);
  return controls.answer({type, request, selector, entity, 64, std::move(data)});
}

TEST(CameraControls, ExposureIsFourBytesWithARange) {
  CameraControls controls;
  EXPECT_EQ(ask(controls, kGetMinimum, kExposureSelector, kCameraEntity), (Bytes{1, 0, 0, 0}));
  EXPECT_EQ(ask(controls, kGetMaximum, kExposureSelector, kCameraEntity),
            (Bytes{0x88, 0x13, 0, 0}));
  EXPECT_EQ(ask(controls, kGetStep, kExposureSelector, kCameraEntity), (Bytes{1, 0, 0, 0}));
  EXPECT_EQ(ask(controls, kGetDefault, kExposureSelector, kCameraEntity), (Bytes{100, 0, 0, 0}));
  EXPECT_EQ(ask(controls, kGetLength, kExposureSelector, kCameraEntity), (Bytes{4, 0}));
  EXPECT_EQ(ask(controls, kGetInfo, kExposureSelector, kCameraEntity), (Bytes{3}));
}

TEST(CameraControls, WhatIsSetIsReadBack) {
  CameraControls controls;
  EXPECT_EQ(ask(controls, kSetCurrent, kGainSelector, kProcessingEntity, {200, 0}), Bytes{});
  EXPECT_EQ(ask(controls, kGetCurrent, kGainSelector, kProcessingEntity), (Bytes{200, 0}));
  EXPECT_EQ(ask(controls, kGetCurrent, kExposureSelector, kCameraEntity), (Bytes{100, 0, 0, 0}));
}

TEST(CameraControls, BeyondTheRangeIsRefusedAndChangesNothing) {
  CameraControls controls;
  EXPECT_EQ(ask(controls, kSetCurrent, kExposureSelector, kCameraEntity, {0x89, 0x13, 0, 0}),
            std::nullopt);
  EXPECT_EQ(ask(controls, kSetCurrent, kExposureSelector, kCameraEntity, {0, 0, 0, 0}),
            std::nullopt);
  EXPECT_EQ(ask(controls, kGetCurrent, kExposureSelector, kCameraEntity), (Bytes{100, 0, 0, 0}));
}

TEST(CameraControls, AnUnknownControlOrRequestIsRefused) {
  CameraControls controls;
  EXPECT_EQ(ask(controls, kGetCurrent, 0x0900, kCameraEntity), std::nullopt);
  EXPECT_EQ(ask(controls, kGetCurrent, kExposureSelector, 0x0500), std::nullopt);
  EXPECT_EQ(ask(controls, 0x90, kExposureSelector, kCameraEntity), std::nullopt);
}

}  // namespace
}  // namespace waymark::uvc
