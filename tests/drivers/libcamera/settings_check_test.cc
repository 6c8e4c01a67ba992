#include "drivers/libcamera/settings_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <libcamera/control_ids.h>

namespace waymark {
namespace {

using testing::HasSubstr;

namespace controls = libcamera::controls;

class SettingsCheckTest : public testing::Test {
 protected:
  SettingsCheckTest() { wanted_.name = "left"; }

  /// Whether a first frame with these metadata would be used.
  [[nodiscard]] bool fits() const {
    SettingsCheck check;
    const auto taken = check.look(metadata_, wanted_);
    return taken && *taken;
  }
  /// What is said of a camera whose frames all have these metadata.
  [[nodiscard]] Error refusal() const {
    SettingsCheck check;
    for (int i = 0; i < 1000; ++i) {
      const auto taken = check.look(metadata_, wanted_);
      if (!taken) return taken.error();
      if (*taken) break;
    }
    return {ErrorKind::internal, "taken"};
  }

  CameraOptions wanted_;
  libcamera::ControlList metadata_{controls::controls};
};

TEST_F(SettingsCheckTest, AnExposureFitsToARowOrTwoPercent) {
  wanted_.controls.exposure_us = 2000;
  for (const auto& [told_us, fits_it] :
       {std::pair(2000, true), {1900, true}, {2100, true}, {1899, false}, {2101, false}}) {
    metadata_.set(controls::ExposureTime, told_us);
    EXPECT_EQ(fits(), fits_it) << told_us;
  }
  wanted_.controls.exposure_us = 500'000;
  for (const auto& [told_us, fits_it] : {std::pair(490'000, true), {489'999, false}}) {
    metadata_.set(controls::ExposureTime, told_us);
    EXPECT_EQ(fits(), fits_it) << told_us;
  }
}

TEST_F(SettingsCheckTest, AGainFitsToTenPercent) {
  wanted_.controls.gain = 4;
  for (const auto& [told, fits_it] :
       {std::pair(4.F, true), {3.61F, true}, {4.39F, true}, {3.59F, false}, {4.41F, false}}) {
    metadata_.set(controls::AnalogueGain, told);
    EXPECT_EQ(fits(), fits_it) << told;
  }
}

TEST_F(SettingsCheckTest, ARateFitsToOnePercent) {
  wanted_.request.fps = 25;
  for (const auto& [told_us, fits_it] : {std::pair(std::int64_t{40'000}, true),
                                         {39'700, true},
                                         {40'300, true},
                                         {39'500, false},
                                         {40'500, false}}) {
    metadata_.set(controls::FrameDuration, told_us);
    EXPECT_EQ(fits(), fits_it) << told_us;
  }
}

TEST_F(SettingsCheckTest, WhatNobodyAskedForOrNobodyTellsFits) {
  EXPECT_TRUE(fits());
  metadata_.set(controls::ExposureTime, 2000);
  metadata_.set(controls::AnalogueGain, 4.F);
  metadata_.set(controls::FrameDuration, std::int64_t{40'000});
  EXPECT_TRUE(fits());
  metadata_.clear();
  wanted_.controls = {1000, 8};
  wanted_.request.fps = 30;
  EXPECT_TRUE(fits());
  metadata_.set(controls::FrameDuration, std::int64_t{0});
  EXPECT_TRUE(fits());
}

TEST_F(SettingsCheckTest, AnExposureThatThePeriodClampsIsRefusedWithWhatTheCameraHas) {
  wanted_.request.fps = 30;
  wanted_.controls = {40'000, 2};
  metadata_.set(controls::FrameDuration, std::int64_t{33'328});
  metadata_.set(controls::ExposureTime, 33'239);
  metadata_.set(controls::AnalogueGain, 2.F);
  const Error refused = refusal();
  EXPECT_EQ(refused.kind, ErrorKind::config);
  EXPECT_THAT(refused.message, HasSubstr("left: exposure_us = 40000 can't be set"));
  EXPECT_THAT(refused.message, HasSubstr("its frames have 33239"));
}

TEST_F(SettingsCheckTest, EachSettingIsNamed) {
  wanted_.controls.gain = 8;
  metadata_.set(controls::AnalogueGain, 1.F);
  EXPECT_THAT(refusal().message, HasSubstr("left: gain = 8 can't be set, its frames have 1;"));
  wanted_.controls.gain.reset();
  wanted_.request.fps = 60;
  metadata_.set(controls::FrameDuration, std::int64_t{40'000});
  EXPECT_THAT(refusal().message, HasSubstr("left: fps = 60 can't be set, its frames have 25;"));
}

TEST_F(SettingsCheckTest, SettingsMayTakeEffectSomeFramesLate) {
  wanted_.controls.exposure_us = 2000;
  SettingsCheck check;
  for (const bool again : {false, true}) {
    check.begin();
    metadata_.set(controls::ExposureTime, 10'000);
    for (int frame = 1; frame < SettingsCheck::kLatest; ++frame) {
      const auto taken = check.look(metadata_, wanted_);
      ASSERT_TRUE(taken) << frame << again;
      EXPECT_FALSE(*taken);
    }
    metadata_.set(controls::ExposureTime, 2000);
    EXPECT_EQ(check.look(metadata_, wanted_), true);
  }
  metadata_.set(controls::ExposureTime, 10'000);
  EXPECT_FALSE(check.look(metadata_, wanted_)) << "the sixteenth that is not as wanted";
}

}  // namespace
}  // namespace waymark
