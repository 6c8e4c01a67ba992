#include "simulator/tile_painter.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "core/base/check.h"
#include "simulator/vector_clones.h"

namespace waymark::simulator {
namespace {

constexpr std::int32_t kNothing = -1;

Eigen::Vector3f ray_at(const RayTable& rays, int corner_x, int corner_y) {
  const RayTable::Row row = rays.row(corner_y);
  const int i = corner_x + rays.padding_px();
  return {row.x[i], row.y[i], row.z[i]};
}

/// Signed tests of a direction against a surface's four edges and its front; inside where all are
/// positive. Linear in the direction.
std::array<float, 5> edge_tests(const PlaneMap& map, float width_m, float height_m,
                                const Eigen::Vector3f& ray) {
  const float across = map.across.dot(ray);
  const float above = map.above.dot(ray);
  const float depth = map.depth.dot(ray);
  return {-across, across - width_m * depth, -above, above - height_m * depth, -depth};
}

}  // namespace

TilePainter::TilePainter(const Renderer::Stage& stage, const RayTable& rays, int radius_px)
    : stage_(stage), rays_(rays), radius_px_(radius_px) {
  WAYMARK_CHECK(rays.padding_px() >= radius_px + SurfacePatch::kReach_px);
}

SubpixelGrid TilePainter::grid_of(const Tile& tile, int oversampling) const {
  return {{tile.x0 - radius_px_, tile.y0 - radius_px_, tile.width + 2 * radius_px_,
           tile.height + 2 * radius_px_},
          oversampling};
}

float TilePainter::share_at(double row_px) const {
  return static_cast<float>((row_px - band_first_px_) /
                            std::max(band_last_px_ - band_first_px_, 1.0));
}

void TilePainter::find_candidates(const Tile& apron, const CameraView& view) {
  candidates_.clear();
  const int right = apron.x0 + apron.width;
  const int bottom = apron.y0 + apron.height;
  const std::array<Eigen::Vector3f, 4> corners = {
      ray_at(rays_, apron.x0, apron.y0), ray_at(rays_, right, apron.y0),
      ray_at(rays_, right, bottom), ray_at(rays_, apron.x0, bottom)};
  for (const MovingPlane& plane : view.surfaces) {
    const Surface& face = stage_.scene->surfaces[static_cast<std::size_t>(plane.index)];
    const auto width_m = static_cast<float>(face.width_m);
    const auto height_m = static_cast<float>(face.height_m);
    std::array<int, 5> corners_inside{};
    for (const auto& corner : corners) {
      const auto first = edge_tests(plane.first, width_m, height_m, corner);
      const auto last = edge_tests(plane.last, width_m, height_m, corner);
      for (std::size_t k = 0; k < 5; ++k) corners_inside[k] += (first[k] > 0) + (last[k] > 0);
    }
    const int fewest = *std::min_element(corners_inside.begin(), corners_inside.end());
    if (fewest > 0) candidates_.push_back({plane, width_m, height_m, fewest == 8});
  }
  // A surface that lies behind one that covers the whole tile is not seen.
  const auto nearness = [](const Candidate& c, const Eigen::Vector3f& ray) {
    return -c.plane.first.depth.dot(ray) / c.plane.first.eye_height;
  };
  const auto farther = [&](const Candidate& a, const Candidate& b) {
    return std::make_pair(a.covers, nearness(a, corners[0])) <
           std::make_pair(b.covers, nearness(b, corners[0]));
  };
  const auto front = std::max_element(candidates_.begin(), candidates_.end(), farther);
  if (front == candidates_.end() || !front->covers) return;
  std::erase_if(candidates_, [&, front = *front](const Candidate& other) {
    return std::all_of(corners.begin(), corners.end(), [&](const Eigen::Vector3f& ray) {
      return nearness(other, ray) < 0.999F * nearness(front, ray);
    });
  });
}

void TilePainter::find_plates(const SubpixelGrid& grid, const CameraView& view) {
  plates_.clear();
  const Tile& apron = grid.apron;
  for (const PlateInView& plate : view.plates) {
    if (plate.left_px >= apron.x0 + apron.width || plate.right_px < apron.x0 ||
        plate.top_px >= apron.y0 + apron.height || plate.bottom_px < apron.y0) {
      continue;
    }
    const auto marker = static_cast<std::size_t>(plate.plane.index);
    const int surface = stage_.scene->markers[marker].surface;
    if (std::any_of(candidates_.begin(), candidates_.end(),
                    [&](const Candidate& c) { return c.plane.index == surface; })) {
      plates_.emplace_back(stage_.prints[marker], plate, surface, grid);
    }
  }
}

bool TilePainter::is_plain(const Tile& tile, const std::vector<CameraView>& views) {
  const SubpixelGrid grid = grid_of(tile, 1);
  return std::all_of(views.begin(), views.end(), [&](const CameraView& view) {
    find_candidates(grid.apron, view);
    find_plates(grid, view);
    return plates_.empty() && one_surface();
  });
}

WAYMARK_VECTOR_CLONES void TilePainter::find_seen(const SubpixelGrid& grid, float share) {
  const std::size_t columns = grid.columns();
  const std::size_t phases = grid.phases();
  for (std::size_t p = 0; p < phases; ++p) {
    const std::size_t left = p * (columns + 1);
    const std::size_t right = p + 1 < phases ? left + columns + 1 : 1;
    // Four times the direction at the sub-pixel's centre; its length does not matter.
    const auto centre = [&](const std::vector<float>& up, const std::vector<float>& low,
                            float* out) {
      for (std::size_t i = 0; i < columns; ++i) {
        out[p * columns + i] = up[left + i] + up[right + i] + low[left + i] + low[right + i];
      }
    };
    centre(upper_.x, lower_.x, centre_x_.data());
    centre(upper_.y, lower_.y, centre_y_.data());
    centre(upper_.z, lower_.z, centre_z_.data());
  }
  const std::size_t length = grid.row_length();
  std::fill_n(seen_.begin(), length, kNothing);
  std::fill_n(nearness_.begin(), length, 0.0F);
  for (std::size_t k = 0; k < candidates_.size(); ++k) {
    const Candidate& c = candidates_[k];
    const PlaneMap map = c.plane.at(share);
    const float per_height = 1.0F / map.eye_height;
    // Where the surface covers the tile, no edge may cut it off by rounding.
    const float slack = c.covers ? std::numeric_limits<float>::infinity() : 0.0F;
    for (std::size_t i = 0; i < length; ++i) {
      const float x = centre_x_[i];
      const float y = centre_y_[i];
      const float z = centre_z_[i];
      const float depth = map.depth.x() * x + map.depth.y() * y + map.depth.z() * z;
      const float across = map.across.x() * x + map.across.y() * y + map.across.z() * z;
      const float above = map.above.x() * x + map.above.y() * y + map.above.z() * z;
      const float inside = std::min(std::min(-across, across - c.width_m * depth),
                                    std::min(-above, above - c.height_m * depth));
      const float nearness = inside + slack >= 0 ? -depth * per_height : 0.0F;
      const bool nearer = nearness > nearness_[i];
      nearness_[i] = nearer ? nearness : nearness_[i];
      seen_[i] = nearer ? static_cast<std::int32_t>(k) : seen_[i];
    }
  }
}

WAYMARK_VECTOR_CLONES void TilePainter::paint_surfaces(const SubpixelGrid& grid, std::size_t row) {
  if (one_surface()) {
    patches_.front().interpolate_albedo(grid, row, albedo_.data());
    patches_.front().interpolate_light(grid, row, light_.data());
    return;
  }
  const std::size_t length = grid.row_length();
  std::fill_n(albedo_.begin(), length, 0.0F);
  std::fill_n(light_.begin(), length, 0.0F);
  for (std::size_t k = 0; k < candidates_.size(); ++k) {
    patches_[k].interpolate_albedo(grid, row, patch_albedo_.data());
    patches_[k].interpolate_light(grid, row, patch_light_.data());
    for (std::size_t i = 0; i < length; ++i) {
      const bool here = seen_[i] == static_cast<std::int32_t>(k);
      albedo_[i] = here ? patch_albedo_[i] : albedo_[i];
      light_[i] = here ? patch_light_[i] : light_[i];
    }
  }
}

void TilePainter::paint_view(const SubpixelGrid& grid, const CameraView& view, float weight) {
  find_candidates(grid.apron, view);
  find_plates(grid, view);
  const float middle_share = share_at(grid.edge_px(0.5 * static_cast<double>(grid.rows())));
  patches_.resize(std::max(patches_.size(), candidates_.size()));
  for (std::size_t k = 0; k < candidates_.size(); ++k) {
    patches_[k].compute(stage_, rays_, grid, candidates_[k].plane, middle_share);
  }
  const std::size_t length = grid.row_length();
  for (auto* values : {&centre_x_, &centre_y_, &centre_z_, &nearness_, &albedo_, &light_,
                       &patch_albedo_, &patch_light_}) {
    values->resize(length);
  }
  seen_.resize(length);
  const auto needs_corners = [&](std::size_t row) {
    return !one_surface() ||
           std::any_of(plates_.begin(), plates_.end(),
                       [&](const PlatePainter& p) { return p.needs_corners(row); });
  };
  const auto advance = [&](std::size_t row) {
    if (!needs_corners(row)) return;
    std::swap(upper_, lower_);
    lower_.compute(rays_, grid, row);
    const float share = share_at(grid.edge_px(static_cast<double>(row)));
    for (PlatePainter& plate : plates_) {
      if (plate.needs_corners(row)) plate.advance(lower_, grid, share);
    }
  };
  advance(0);
  for (std::size_t row = 0; row < grid.rows(); ++row) {
    advance(row + 1);
    if (!one_surface()) find_seen(grid, share_at(grid.edge_px(static_cast<double>(row) + 0.5)));
    paint_surfaces(grid, row);
    for (const PlatePainter& plate : plates_) {
      if (!plate.reaches(row)) continue;
      const auto on = std::find_if(candidates_.begin(), candidates_.end(), [&](const Candidate& c) {
        return c.plane.index == plate.surface();
      });
      plate.paint(grid, one_surface() ? nullptr : seen_.data(),
                  static_cast<std::int32_t>(on - candidates_.begin()), albedo_.data());
    }
    float* out = canvas_.data() + row * length;
    for (std::size_t i = 0; i < length; ++i) out[i] += weight * albedo_[i] * light_[i];
  }
}

void TilePainter::paint(const Tile& tile, const std::vector<CameraView>& views,
                        double band_first_px, double band_last_px, const PointSpread& spread,
                        IrradianceImage& out) {
  band_first_px_ = band_first_px;
  band_last_px_ = band_last_px;
  const SubpixelGrid grid = grid_of(tile, spread.oversampling());
  canvas_.assign(grid.rows() * grid.row_length(), 0.0F);
  for (const CameraView& view : views) {
    paint_view(grid, view, 1.0F / static_cast<float>(views.size()));
  }
  reduce(tile, grid, spread, out);
}

void TilePainter::reduce(const Tile& tile, const SubpixelGrid& grid, const PointSpread& spread,
                         IrradianceImage& out) {
  const auto width = static_cast<std::size_t>(tile.width);
  half_reduced_.resize(grid.rows() * width);
  for (std::size_t row = 0; row < grid.rows(); ++row) {
    spread.reduce_row(canvas_.data() + row * grid.row_length(), grid.columns(), width,
                      half_reduced_.data() + row * width);
  }
  for (int y = 0; y < tile.height; ++y) {
    const float* rows = half_reduced_.data() + static_cast<std::size_t>(y) * grid.phases() * width;
    float* pixels = out.values.data() +
                    static_cast<std::size_t>(tile.y0 + y) * static_cast<std::size_t>(out.width_px) +
                    static_cast<std::size_t>(tile.x0);
    spread.reduce_column(rows, width, width, pixels);
  }
}

}  // namespace waymark::simulator
