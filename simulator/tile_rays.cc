#include "simulator/tile_rays.h"

#include "simulator/vector_clones.h"

namespace waymark::simulator {
namespace {

/// Interpolates one coordinate between pixel corners, `down` and phase by phase to the right.
WAYMARK_VECTOR_CLONES void interpolate(const float* upper, const float* lower, float down,
                                       std::size_t stride, std::size_t phases,
                                       std::vector<float>& out) {
  out.resize(phases * stride + 1);  // and the pixel corner that the last phases lead to
  float* here = out.data();
  for (std::size_t i = 0; i <= stride; ++i) here[i] = upper[i] + down * (lower[i] - upper[i]);
  // The first phase stands there already and is the others' source; only its end is overwritten.
  const float end = here[stride];
  for (std::size_t p = 1; p < phases; ++p) {
    const float right = static_cast<float>(p) / static_cast<float>(phases);
    float* values = out.data() + p * stride;
    for (std::size_t i = 0; i + 1 < stride; ++i) {
      values[i] = here[i] + right * (here[i + 1] - here[i]);
    }
    values[stride - 1] = here[stride - 1] + right * (end - here[stride - 1]);
  }
}

}  // namespace

void CornerRays::compute(const RayTable& rays, const SubpixelGrid& grid, std::size_t row) {
  const std::size_t phases = grid.phases();
  const int corner_y = grid.apron.y0 + static_cast<int>(row / phases);
  const float down = static_cast<float>(row % phases) / static_cast<float>(phases);
  const RayTable::Row upper = rays.row(corner_y);
  const RayTable::Row lower = rays.row(row % phases == 0 ? corner_y : corner_y + 1);
  const int first = grid.apron.x0 + rays.padding_px();
  const std::size_t stride = grid.columns() + 1;
  interpolate(upper.x + first, lower.x + first, down, stride, phases, x);
  interpolate(upper.y + first, lower.y + first, down, stride, phases, y);
  interpolate(upper.z + first, lower.z + first, down, stride, phases, z);
}

}  // namespace waymark::simulator
