#include "simulator/surface_patch.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/check.h"
#include "simulator/vector_clones.h"

namespace waymark::simulator {
namespace {

constexpr int kAlbedoStep_px = 2;
constexpr int kLightStep_px = 8;
static_assert(kLightStep_px + 1 <= SurfacePatch::kReach_px);

/// Directions closer to the surface's horizon than this are taken as if they were not.
constexpr float kLeastDepth = 1e-4F;

int nodes_along(int length_px, int step_px) { return length_px / step_px + 2; }

/// Nodes of a row: enough for the widest apron.
constexpr std::size_t kMostColumns = 256;

/// Plane coordinates (m) that `count` rays hit, every `step`-th of a row.
WAYMARK_VECTOR_CLONES void hit_plane(const RayTable::Row& row, std::size_t step,
                                     const PlaneMap& map, std::size_t count, float* across,
                                     float* above) {
  for (std::size_t i = 0; i < count; ++i) {
    const float x = row.x[i * step];
    const float y = row.y[i * step];
    const float z = row.z[i * step];
    const float per_depth =
        1.0F / std::min(map.depth.x() * x + map.depth.y() * y + map.depth.z() * z, -kLeastDepth);
    across[i] = (map.across.x() * x + map.across.y() * y + map.across.z() * z) * per_depth;
    above[i] = (map.above.x() * x + map.above.y() * y + map.above.z() * z) * per_depth;
  }
}

/// Plane coordinates (m) that the rays through the nodes hit, node by node.
template <typename Visit>
void visit_nodes(const RayTable& rays, const Tile& apron, const PlaneMap& map, int step_px,
                 const Visit& visit) {
  const auto columns = static_cast<std::size_t>(nodes_along(apron.width, step_px));
  WAYMARK_CHECK(columns <= kMostColumns);
  const int rows = nodes_along(apron.height, step_px);
  const int first = apron.x0 + rays.padding_px();
  std::array<float, kMostColumns> across;
  std::array<float, kMostColumns> above;
  for (int j = 0; j < rows; ++j) {
    const RayTable::Row row = rays.row(apron.y0 + j * step_px);
    hit_plane({row.x + first, row.y + first, row.z + first}, static_cast<std::size_t>(step_px), map,
              columns, across.data(), above.data());
    for (std::size_t i = 0; i < columns; ++i) visit(across[i], above[i]);
  }
}

/// What a pixel in the middle of the tile covers of the plane (m).
float footprint_m(const RayTable& rays, const Tile& apron, const PlaneMap& map) {
  std::array<Eigen::Vector2f, 4> hits;
  std::size_t count = 0;
  const Tile middle{apron.x0 + apron.width / 2, apron.y0 + apron.height / 2, 0, 0};
  visit_nodes(rays, middle, map, 1, [&](float across, float above) {
    hits[count++] = {across, above};
  });
  return std::max((hits[1] - hits[0]).norm(), (hits[2] - hits[0]).norm());
}

template <int kStep_px>
void interpolate(const std::vector<float>& nodes, const SubpixelGrid& grid, std::size_t row,
                 float* out) {
  constexpr auto kStep = static_cast<std::size_t>(kStep_px);
  const auto node_columns = static_cast<std::size_t>(nodes_along(grid.apron.width, kStep_px));
  const auto n = static_cast<float>(grid.oversampling);
  const float y = (static_cast<float>(row) + 0.5F) / (n * static_cast<float>(kStep_px));
  const auto node_row = static_cast<std::size_t>(y);
  const float down = y - static_cast<float>(node_row);
  const float* upper = nodes.data() + node_row * node_columns;
  const float* lower = upper + node_columns;
  const std::size_t columns = grid.columns();
  const std::size_t whole = columns / kStep;
  for (std::size_t p = 0; p < grid.phases(); ++p) {
    float* values = out + p * columns;
    const float first = (static_cast<float>(p) + 0.5F) / (n * static_cast<float>(kStep_px));
    float left = upper[0] + down * (lower[0] - upper[0]);
    for (std::size_t k = 0; k <= whole; ++k) {
      const float right = upper[k + 1] + down * (lower[k + 1] - upper[k + 1]);
      const std::size_t count = k < whole ? kStep : columns - whole * kStep;
      for (std::size_t b = 0; b < count; ++b) {
        const float across = first + static_cast<float>(b) / static_cast<float>(kStep_px);
        values[k * kStep + b] = left + across * (right - left);
      }
      left = right;
    }
  }
}

}  // namespace

void SurfacePatch::compute(const Renderer::Stage& stage, const RayTable& rays,
                           const SubpixelGrid& grid, const MovingPlane& plane, float share) {
  const PlaneMap map = plane.at(share);
  const auto index = static_cast<std::size_t>(plane.index);
  const float base = stage.albedo_by_surface[index];
  const std::size_t level = stage.texture.level_for(0.7F * footprint_m(rays, grid.apron, map));
  albedo_.clear();
  visit_nodes(rays, grid.apron, map, kAlbedoStep_px, [&](float across, float above) {
    albedo_.push_back(base * stage.texture.sample(level, across, above));
  });
  light_.clear();
  visit_nodes(rays, grid.apron, map, kLightStep_px, [&](float across, float above) {
    light_.push_back(stage.illumination.at(plane.index, across, above));
  });
}

void SurfacePatch::interpolate_albedo(const SubpixelGrid& grid, std::size_t row, float* out) const {
  interpolate<kAlbedoStep_px>(albedo_, grid, row, out);
}

void SurfacePatch::interpolate_light(const SubpixelGrid& grid, std::size_t row, float* out) const {
  interpolate<kLightStep_px>(light_, grid, row, out);
}

}  // namespace waymark::simulator
