#include "core/camera/sensor_response.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

class Responses : public testing::TestWithParam<SensorResponse> {};

TEST_P(Responses, DecodingUndoesEncoding) {
  for (int i = 0; i <= 100; ++i) {
    const double light = 0.01 * i;
    EXPECT_NEAR(decode(GetParam(), encode(GetParam(), light).grey), light, 1e-12) << light;
  }
}

TEST_P(Responses, KeepBlackAndWhite) {
  EXPECT_NEAR(encode(GetParam(), 0).grey, 0, 1e-12);
  EXPECT_NEAR(encode(GetParam(), 1).grey, 1, 1e-12);
}

TEST_P(Responses, SlopesAreThoseOfDifferences) {
  constexpr double kStep = 1e-7;
  for (const double light : {-0.2, 0.001, 0.0032, 0.02, 0.5, 1.0, 1.3}) {
    const double numeric =
        (encode(GetParam(), light + kStep).grey - encode(GetParam(), light - kStep).grey) /
        (2 * kStep);
    EXPECT_NEAR(encode(GetParam(), light).slope, numeric, 1e-5 * numeric) << light;
  }
}

INSTANTIATE_TEST_SUITE_P(All, Responses,
                         testing::Values(SensorResponse::linear, SensorResponse::srgb),
                         [](const auto& info) { return std::string(to_string(info.param)); });

TEST(SrgbResponse, MakesMiddleGreyBright) {
  // IEC 61966-2-1: 18 % of the light is 46 % grey.
  EXPECT_NEAR(encode(SensorResponse::srgb, 0.18).grey, 0.4613, 1e-4);
}

TEST(SensorResponse, NamesComeBack) {
  for (const SensorResponse response : {SensorResponse::linear, SensorResponse::srgb}) {
    EXPECT_EQ(sensor_response_from(to_string(response)), response);
  }
  EXPECT_FALSE(sensor_response_from("auto"));
  EXPECT_FALSE(sensor_response_from(""));
}

}  // namespace
}  // namespace waymark
