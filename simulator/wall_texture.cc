#include "simulator/wall_texture.h"

#include <algorithm>
#include <cmath>

#include "simulator/random.h"

namespace waymark::simulator {
namespace {

constexpr std::uint32_t kSideLog2 = 9;
constexpr std::size_t kSide = std::size_t{1} << kSideLog2;
constexpr float kTexelsPerMetre = 128.0F;  ///< 8 mm each; the pattern repeats after 4 m

/// Adds smooth noise whose lattice has `cells` cells along the side.
void add_octave(std::vector<float>& values, std::size_t cells, float amplitude, Random& random) {
  std::vector<float> lattice(cells * cells);
  for (float& v : lattice) v = static_cast<float>(random.uniform(-1, 1));
  const float scale = static_cast<float>(cells) / kSide;
  const auto eased = [](float t) { return t * t * (3 - 2 * t); };
  for (std::size_t y = 0; y < kSide; ++y) {
    const float ly = static_cast<float>(y) * scale;
    const auto y0 = static_cast<std::size_t>(ly) % cells;
    const std::size_t y1 = (y0 + 1) % cells;
    const float fy = eased(ly - std::floor(ly));
    for (std::size_t x = 0; x < kSide; ++x) {
      const float lx = static_cast<float>(x) * scale;
      const auto x0 = static_cast<std::size_t>(lx) % cells;
      const std::size_t x1 = (x0 + 1) % cells;
      const float fx = eased(lx - std::floor(lx));
      const float top = std::lerp(lattice[y0 * cells + x0], lattice[y0 * cells + x1], fx);
      const float bottom = std::lerp(lattice[y1 * cells + x0], lattice[y1 * cells + x1], fx);
      values[y * kSide + x] += amplitude * std::lerp(top, bottom, fy);
    }
  }
}

void normalize(std::vector<float>& values, double contrast) {
  double sum = 0;
  double squares = 0;
  for (const float v : values) {
    sum += v;
    squares += static_cast<double>(v) * v;
  }
  const double mean = sum / static_cast<double>(values.size());
  const double deviation = std::sqrt(squares / static_cast<double>(values.size()) - mean * mean);
  for (float& v : values) {
    v = static_cast<float>(std::max(0.1, 1.0 + contrast * (v - mean) / deviation));
  }
}

std::vector<float> halved(const std::vector<float>& in, std::size_t side) {
  std::vector<float> out;
  out.reserve(side * side / 4);
  for (std::size_t y = 0; y < side; y += 2) {
    for (std::size_t x = 0; x < side; x += 2) {
      out.push_back(0.25F * (in[y * side + x] + in[y * side + x + 1] + in[(y + 1) * side + x] +
                             in[(y + 1) * side + x + 1]));
    }
  }
  return out;
}

}  // namespace

WallTexture::WallTexture(std::uint64_t seed, double contrast) {
  Random random = Random::of({seed, 2});
  std::vector<float> finest(kSide * kSide, 0.0F);
  float amplitude = 1.0F;
  for (std::size_t cells = 2; cells <= kSide / 2; cells *= 2) {
    add_octave(finest, cells, amplitude, random);
    amplitude *= 0.72F;
  }
  normalize(finest, contrast);
  storage_.push_back(std::move(finest));
  for (std::size_t side = kSide; side > 1; side /= 2)
    storage_.push_back(halved(storage_.back(), side));
  for (std::size_t i = 0; i < storage_.size(); ++i) {
    const std::uint32_t shift = kSideLog2 - static_cast<std::uint32_t>(i);
    levels_.push_back({storage_[i].data(), (1U << shift) - 1, shift,
                       std::ldexp(kTexelsPerMetre, -static_cast<int>(i))});
  }
}

std::size_t WallTexture::level_for(float footprint_m) const {
  std::size_t level = 0;
  for (float texel_m = 1 / kTexelsPerMetre; texel_m < footprint_m && level + 1 < levels_.size();
       texel_m *= 2) {
    ++level;
  }
  return level;
}

}  // namespace waymark::simulator
