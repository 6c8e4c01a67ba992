#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace waymark::simulator {

/// Stains, plaster and grain: noise of many scales on a periodic square, with coarser copies for
/// far walls. Values average 1; multiply a wall's albedo by them.
class WallTexture {
 public:
  /// `contrast`: standard deviation over mean, 0…0.5.
  WallTexture(std::uint64_t seed, double contrast);

  /// The copy to use where a pixel covers about `footprint_m` of the wall.
  [[nodiscard]] std::size_t level_for(float footprint_m) const;

  /// Bilinear sample at plane coordinates (m), which may be any finite numbers.
  [[nodiscard]] float sample(std::size_t level, float across_m, float above_m) const {
    const Level& l = levels_[level];
    const float x = across_m * l.texels_per_m + 4096.0F * static_cast<float>(l.mask + 1);
    const float y = above_m * l.texels_per_m + 4096.0F * static_cast<float>(l.mask + 1);
    const auto ix = static_cast<std::int32_t>(x);
    const auto iy = static_cast<std::int32_t>(y);
    const float fx = x - static_cast<float>(ix);
    const float fy = y - static_cast<float>(iy);
    const auto x0 = static_cast<std::uint32_t>(ix) & l.mask;
    const auto x1 = static_cast<std::uint32_t>(ix + 1) & l.mask;
    const float* r0 = l.values + ((static_cast<std::uint32_t>(iy) & l.mask) << l.shift);
    const float* r1 = l.values + ((static_cast<std::uint32_t>(iy + 1) & l.mask) << l.shift);
    const float top = r0[x0] + fx * (r0[x1] - r0[x0]);
    const float bottom = r1[x0] + fx * (r1[x1] - r1[x0]);
    return top + fy * (bottom - top);
  }

 private:
  struct Level {
    const float* values;
    std::uint32_t mask;   ///< side − 1
    std::uint32_t shift;  ///< log2(side)
    float texels_per_m;
  };

  std::vector<std::vector<float>> storage_;
  std::vector<Level> levels_;
};

}  // namespace waymark::simulator
