#include "core/camera/sensor_response.h"

#include <cmath>

namespace waymark {
namespace {

// IEC 61966-2-1: a straight line near black, then a power.
constexpr double kLineSlope = 12.92;
constexpr double kLineEnd = 0.0031308;
constexpr double kOffset = 0.055;
constexpr double kPower = 2.4;

}  // namespace

std::string_view to_string(SensorResponse response) {
  return response == SensorResponse::linear ? "linear" : "srgb";
}

std::optional<SensorResponse> sensor_response_from(std::string_view name) {
  for (const SensorResponse response : {SensorResponse::linear, SensorResponse::srgb}) {
    if (name == to_string(response)) return response;
  }
  return std::nullopt;
}

EncodedLight encode(SensorResponse response, double light) {
  if (response == SensorResponse::linear) return {light, 1.0};
  if (light <= kLineEnd) return {kLineSlope * light, kLineSlope};
  const double root = (1 + kOffset) * std::pow(light, 1 / kPower);
  return {root - kOffset, root / (kPower * light)};
}

double decode(SensorResponse response, double grey) {
  if (response == SensorResponse::linear) return grey;
  if (grey <= kLineSlope * kLineEnd) return grey / kLineSlope;
  return std::pow((grey + kOffset) / (1 + kOffset), kPower);
}

}  // namespace waymark
