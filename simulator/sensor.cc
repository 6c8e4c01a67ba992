#include "simulator/sensor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "simulator/random.h"
#include "simulator/vector_clones.h"

namespace waymark::simulator {
namespace {

constexpr std::size_t kDeviates = std::size_t{1} << 18U;
constexpr std::size_t kLongestRow = 16384;

/// sRGB's curve from linear level to coded level, both 0…255, in steps of 1/16 level.
std::vector<float> srgb_curve() {
  std::vector<float> curve;
  for (int i = 0; i <= 255 * 16 + 16; ++i) {
    const double linear = i / (255.0 * 16.0);
    const double coded =
        linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    curve.push_back(static_cast<float>(255.0 * coded));
  }
  return curve;
}

void apply_srgb(std::vector<float>& levels) {
  static const std::vector<float> curve = srgb_curve();
  for (float& level : levels) {
    const float place = std::clamp(level, 0.0F, 255.0F) * 16.0F;
    const auto i = static_cast<std::size_t>(place);
    level = std::lerp(curve[i], curve[i + 1], place - static_cast<float>(i));
  }
}

}  // namespace

Sensor::Sensor(const RenderSettings& settings) : settings_(settings) {
  Random random(0x6E6F697365ULL);
  normal_deviates_.reserve(kDeviates + kLongestRow);
  for (std::size_t i = 0; i < kDeviates; ++i) {
    normal_deviates_.push_back(static_cast<float>(random.normal()));
  }
  normal_deviates_.insert(normal_deviates_.end(), normal_deviates_.begin(),
                          normal_deviates_.begin() + kLongestRow);
}

WAYMARK_VECTOR_CLONES GrayImage Sensor::expose(const IrradianceImage& light,
                                               std::uint64_t seed) const {
  GrayImage image(light.width_px, light.height_px);
  Random random(seed);
  const auto level_per_light = static_cast<float>(settings_.white_level / settings_.white_albedo);
  const double electrons_per_level = settings_.full_well_e / 255.0;
  const double read_level = settings_.read_noise_e / electrons_per_level;
  const auto read_variance = static_cast<float>(read_level * read_level);
  const auto shot_variance_per_level = static_cast<float>(1.0 / electrons_per_level);
  const float centre_x = 0.5F * static_cast<float>(light.width_px - 1);
  const float centre_y = 0.5F * static_cast<float>(light.height_px - 1);
  const float loss_per_r2 =
      static_cast<float>(settings_.vignetting) / (centre_x * centre_x + centre_y * centre_y);
  const auto width = static_cast<std::size_t>(light.width_px);
  std::vector<float> levels(width);
  for (int y = 0; y < light.height_px; ++y) {
    const float* in = light.values.data() + static_cast<std::size_t>(y) * width;
    const float dy = static_cast<float>(y) - centre_y;
    for (std::size_t x = 0; x < width; ++x) {
      const float dx = static_cast<float>(x) - centre_x;
      levels[x] = in[x] * level_per_light * (1.0F - loss_per_r2 * (dx * dx + dy * dy));
    }
    if (settings_.noise) {
      // Rows longer than the deviates' tail would read past the end: start earlier then.
      const float* deviates = normal_deviates_.data() +
                              random.below(kDeviates + kLongestRow - std::min(width, kDeviates));
      for (std::size_t x = 0; x < width; ++x) {
        levels[x] += deviates[x] * std::sqrt(read_variance + shot_variance_per_level * levels[x]);
      }
    }
    if (settings_.response == Response::srgb) apply_srgb(levels);
    std::uint8_t* out = image.row(y);
    for (std::size_t x = 0; x < width; ++x) {
      out[x] = static_cast<std::uint8_t>(std::clamp(levels[x] + 0.5F, 0.0F, 255.0F));
    }
  }
  return image;
}

}  // namespace waymark::simulator
