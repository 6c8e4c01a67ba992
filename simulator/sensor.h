#pragma once

#include <cstdint>
#include <vector>

#include "core/capture/gray_image.h"
#include "simulator/render_settings.h"

namespace waymark::simulator {

/// Light on the sensor, row by row; 1 is what a perfectly white, well-lit surface sends.
struct IrradianceImage {
  int width_px = 0;
  int height_px = 0;
  std::vector<float> values;
};

/// Turns light into 8-bit grey levels: vignetting, electrons with shot and read noise, saturation,
/// response curve, rounding.
class Sensor {
 public:
  explicit Sensor(const RenderSettings& settings);

  /// The same seed gives the same noise.
  [[nodiscard]] GrayImage expose(const IrradianceImage& light, std::uint64_t seed) const;

 private:
  RenderSettings settings_;
  std::vector<float>
      normal_deviates_;  ///< drawn once; each image row reads them from a place of its own
};

}  // namespace waymark::simulator
