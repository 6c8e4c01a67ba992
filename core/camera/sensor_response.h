#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace waymark {

/// How a camera turns light into grey values: in proportion, or as sRGB encodes (most webcams,
/// IEC 61966-2-1). Gamma moves every edge of a blurred image into the dark.
enum class SensorResponse : std::uint8_t { linear, srgb };

[[nodiscard]] std::string_view to_string(SensorResponse response);

/// nullopt for an unknown name.
[[nodiscard]] std::optional<SensorResponse> sensor_response_from(std::string_view name);

/// A grey value (0 black, 1 white) and how it grows with light.
struct EncodedLight {
  double grey = 0;
  double slope = 1;
};

/// Of any light, below 0 and above 1 continued.
[[nodiscard]] EncodedLight encode(SensorResponse response, double light);
/// The light of a grey value in [0, 1].
[[nodiscard]] double decode(SensorResponse response, double grey);

}  // namespace waymark
