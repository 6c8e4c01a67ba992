#include "simulator/tile_painter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/check.h"

namespace waymark::simulator {
namespace {

constexpr std::uint8_t kNothing = 255;

/// Spacing of the nodes at which light and shadow are computed; between them they are interpolated.
constexpr int kLightStep_px = 8;

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
  WAYMARK_CHECK(rays.padding_px() >= radius_px + 2 * kLightStep_px);
}

void TilePainter::find_candidates(const Tile& tile, const CameraView& view) {
  candidates_.clear();
  const int left = tile.x0 - radius_px_;
  const int right = tile.x0 + tile.width + radius_px_;
  const int top = tile.y0 - radius_px_;
  const int bottom = tile.y0 + tile.height + radius_px_;
  const std::array<Eigen::Vector3f, 4> corners = {
      ray_at(rays_, left, top), ray_at(rays_, right, top), ray_at(rays_, right, bottom),
      ray_at(rays_, left, bottom)};
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
    const auto [fewest, most] = std::minmax_element(corners_inside.begin(), corners_inside.end());
    if (*fewest == 0) continue;
    candidates_.push_back({plane.index, plane, width_m, height_m, *fewest == 8, 0, {}});
  }
  WAYMARK_CHECK(candidates_.size() < kNothing);
  // A surface that lies behind one that covers the whole tile is not seen.
  const auto nearness = [](const Candidate& c, const Eigen::Vector3f& ray) {
    return -c.plane.first.depth.dot(ray) / c.plane.first.eye_height;
  };
  const auto nearer = [&](const Candidate& a, const Candidate& b) {
    return std::make_pair(a.covers, nearness(a, corners[0])) <
           std::make_pair(b.covers, nearness(b, corners[0]));
  };
  const auto front = std::max_element(candidates_.begin(), candidates_.end(), nearer);
  if (front == candidates_.end() || !front->covers) return;
  std::erase_if(candidates_, [&, front = *front](const Candidate& other) {
    return std::all_of(corners.begin(), corners.end(), [&](const Eigen::Vector3f& ray) {
      return nearness(other, ray) < 0.999F * nearness(front, ray);
    });
  });
}

void TilePainter::light_candidates(const Tile& tile, int n) {
  const int left = tile.x0 - radius_px_;
  const int top = tile.y0 - radius_px_;
  const int columns = (tile.width + 2 * radius_px_) / kLightStep_px + 2;
  const int rows = (tile.height + 2 * radius_px_) / kLightStep_px + 2;
  const int middle_x = tile.x0 + tile.width / 2;
  const int middle_y = tile.y0 + tile.height / 2;
  for (Candidate& c : candidates_) {
    const PlaneMap map = c.plane.at(0.5F);
    const auto hit = [&](const Eigen::Vector3f& ray) {
      // Beyond the horizon of a surface that only touches the tile, its nearest light will do.
      const float depth = std::min(map.depth.dot(ray), -1e-4F);
      return Eigen::Vector2f(std::clamp(map.across.dot(ray) / depth, 0.0F, c.width_m),
                             std::clamp(map.above.dot(ray) / depth, 0.0F, c.height_m));
    };
    const float footprint_m =
        (hit(ray_at(rays_, middle_x + 1, middle_y)) - hit(ray_at(rays_, middle_x, middle_y + 1)))
            .norm() /
        static_cast<float>(n);
    c.texture_level = stage_.texture.level_for(0.7F * footprint_m);
    c.light.clear();
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i < columns; ++i) {
        const Eigen::Vector2f at = hit(
            ray_at(rays_, std::min(left + i * kLightStep_px, rays_.width_px() + rays_.padding_px()),
                   std::min(top + j * kLightStep_px, rays_.height_px() + rays_.padding_px())));
        c.light.push_back(stage_.illumination.at(c.surface, at.x(), at.y()));
      }
    }
  }
}

void TilePainter::find_plates(const Tile& tile, const CameraView& view, int n) {
  plates_.clear();
  const int left = tile.x0 - radius_px_;
  const int right = tile.x0 + tile.width + radius_px_ - 1;
  const int top = tile.y0 - radius_px_;
  const int bottom = tile.y0 + tile.height + radius_px_ - 1;
  for (const PlateInView& plate : view.plates) {
    if (plate.left_px > right || plate.right_px < left || plate.top_px > bottom ||
        plate.bottom_px < top) {
      continue;
    }
    const auto marker = static_cast<std::size_t>(plate.plane.index);
    const int surface = stage_.scene->markers[marker].surface;
    if (std::none_of(candidates_.begin(), candidates_.end(),
                     [&](const Candidate& c) { return c.surface == surface; })) {
      continue;
    }
    const auto column = [&](int px) { return static_cast<std::size_t>((px - left) * n); };
    const std::size_t begin = column(std::max(plate.left_px, left));
    const std::size_t end = column(std::min(plate.right_px, right) + 1);
    plates_.push_back({&stage_.prints[marker],
                       plate.plane,
                       surface,
                       begin,
                       end,
                       (std::max(plate.top_px, top) - top) * n,
                       (std::min(plate.bottom_px, bottom) - top + 1) * n - 1,
                       {},
                       {},
                       {},
                       {}});
    for (auto* values : {&plates_.back().upper_x, &plates_.back().upper_y, &plates_.back().lower_x,
                         &plates_.back().lower_y}) {
      values->resize(end - begin + 1);
    }
  }
}

bool TilePainter::is_plain(const Tile& tile, const std::vector<CameraView>& views) {
  return std::all_of(views.begin(), views.end(), [&](const CameraView& view) {
    find_candidates(tile, view);
    find_plates(tile, view, 1);
    return plates_.empty() && candidates_.size() == 1 && candidates_.front().covers;
  });
}

void TilePainter::corner_rays(const Tile& tile, int n, std::size_t row, RayRow& out) {
  const auto un = static_cast<std::size_t>(n);
  const std::size_t columns = static_cast<std::size_t>(tile.width + 2 * radius_px_);
  const int y = tile.y0 - radius_px_ + static_cast<int>(row / un);
  const float down = static_cast<float>(row % un) / static_cast<float>(n);
  const RayTable::Row upper = rays_.row(y);
  const RayTable::Row lower = rays_.row(row % un == 0 ? y : y + 1);
  const int first = tile.x0 - radius_px_ + rays_.padding_px();
  const auto fill = [&](const float* a, const float* b, std::vector<float>& values) {
    a += first;
    b += first;
    pixel_corners_.resize(columns + 1);
    for (std::size_t i = 0; i <= columns; ++i) pixel_corners_[i] = a[i] + down * (b[i] - a[i]);
    for (std::size_t k = 0; k < un; ++k) {
      const float right = static_cast<float>(k) / static_cast<float>(n);
      for (std::size_t i = 0; i < columns; ++i) {
        values[i * un + k] =
            pixel_corners_[i] + right * (pixel_corners_[i + 1] - pixel_corners_[i]);
      }
    }
    values[columns * un] = pixel_corners_[columns];
  };
  fill(upper.x, lower.x, out.x);
  fill(upper.y, lower.y, out.y);
  fill(upper.z, lower.z, out.z);
}

void TilePainter::choose_surfaces(std::size_t columns, float share) {
  if (candidates_.size() == 1 && candidates_.front().covers) {
    std::fill_n(seen_.begin(), columns, std::uint8_t{0});
    return;
  }
  std::fill_n(seen_.begin(), columns, kNothing);
  std::fill_n(nearness_.begin(), columns, 0.0F);
  for (std::size_t k = 0; k < candidates_.size(); ++k) {
    const Candidate& c = candidates_[k];
    const PlaneMap map = c.plane.at(share);
    const float per_height = 1.0F / map.eye_height;
    for (std::size_t i = 0; i < columns; ++i) {
      const float x = centre_.x[i];
      const float y = centre_.y[i];
      const float z = centre_.z[i];
      const float depth = map.depth.x() * x + map.depth.y() * y + map.depth.z() * z;
      const float across = map.across.x() * x + map.across.y() * y + map.across.z() * z;
      const float above = map.above.x() * x + map.above.y() * y + map.above.z() * z;
      const float nearness = -depth * per_height;
      const bool hit = c.covers || (across <= 0 && across >= c.width_m * depth && above <= 0 &&
                                    above >= c.height_m * depth);
      if (hit && nearness > nearness_[i]) {
        nearness_[i] = nearness;
        seen_[i] = static_cast<std::uint8_t>(k);
      }
    }
  }
}

void TilePainter::paint_surfaces(std::size_t row, std::size_t columns, int n, float share) {
  // One surface alone is smooth enough for a sample per pixel; edges between surfaces need all
  // sub-pixels.
  const bool alone = candidates_.size() == 1 && candidates_.front().covers;
  const std::size_t step = alone ? static_cast<std::size_t>(n) : 1;
  if (row % step != 0) return;
  const std::size_t light_columns = columns / static_cast<std::size_t>(n * kLightStep_px) + 2;
  const float light_scale = 1.0F / static_cast<float>(kLightStep_px * n);
  const float light_y = static_cast<float>(row) * light_scale;
  const auto light_row = static_cast<std::size_t>(light_y);
  const float fy = light_y - static_cast<float>(light_row);
  for (std::size_t begin = 0; begin < columns;) {
    std::size_t end = alone ? columns : begin + 1;
    while (end < columns && seen_[end] == seen_[begin]) ++end;
    if (seen_[begin] == kNothing) {
      std::fill(background_.begin() + static_cast<std::ptrdiff_t>(begin),
                background_.begin() + static_cast<std::ptrdiff_t>(end), 0.0F);
      begin = end;
      continue;
    }
    const Candidate& c = candidates_[seen_[begin]];
    const PlaneMap map = c.plane.at(share);
    const float base = stage_.albedo_by_surface[static_cast<std::size_t>(c.surface)];
    const float* upper_light = c.light.data() + light_row * light_columns;
    const float* lower_light = upper_light + light_columns;
    for (std::size_t i = begin; i < end; i += step) {
      const float x = centre_.x[i];
      const float y = centre_.y[i];
      const float z = centre_.z[i];
      const float per_depth =
          1.0F / std::min(map.depth.x() * x + map.depth.y() * y + map.depth.z() * z, -1e-4F);
      const float across =
          (map.across.x() * x + map.across.y() * y + map.across.z() * z) * per_depth;
      const float above = (map.above.x() * x + map.above.y() * y + map.above.z() * z) * per_depth;
      const float albedo = base * stage_.texture.sample(c.texture_level, across, above);
      const float light_x = static_cast<float>(i) * light_scale;
      const auto k = static_cast<std::size_t>(light_x);
      const float fx = light_x - static_cast<float>(k);
      const float upper = upper_light[k] + fx * (upper_light[k + 1] - upper_light[k]);
      const float lower = lower_light[k] + fx * (lower_light[k + 1] - lower_light[k]);
      const float light = upper + fy * (lower - upper);
      for (std::size_t j = 0; j < step; ++j) {
        background_[i + j] = albedo;
        light_[i + j] = light;
      }
    }
    begin = end;
  }
}

void TilePainter::plate_corners(Plate& plate, float share) const {
  const PlaneMap map = plate.plane.at(share);
  const float half = 0.5F * static_cast<float>(plate.print->side_cells());
  const std::size_t count = plate.end - plate.begin + 1;
  for (std::size_t i = 0; i < count; ++i) {
    const float x = lower_.x[plate.begin + i];
    const float y = lower_.y[plate.begin + i];
    const float z = lower_.z[plate.begin + i];
    const float per_depth =
        1.0F / std::min(map.depth.x() * x + map.depth.y() * y + map.depth.z() * z, -1e-6F);
    plate.lower_x[i] =
        half + (map.across.x() * x + map.across.y() * y + map.across.z() * z) * per_depth;
    plate.lower_y[i] =
        half - (map.above.x() * x + map.above.y() * y + map.above.z() * z) * per_depth;
  }
}

void TilePainter::paint_plate(Plate& plate, std::size_t row, float share) {
  const int irow = static_cast<int>(row);
  if (irow < plate.first_row - 1 || irow > plate.last_row) return;
  std::swap(plate.upper_x, plate.lower_x);
  std::swap(plate.upper_y, plate.lower_y);
  plate_corners(plate, share);
  if (irow < plate.first_row) return;
  for (std::size_t i = plate.begin; i < plate.end; ++i) {
    if (seen_[i] == kNothing || candidates_[seen_[i]].surface != plate.surface) continue;
    const std::size_t k = i - plate.begin;
    albedo_[i] = plate.print->albedo(
        {{plate.upper_x[k], plate.upper_x[k + 1], plate.lower_x[k + 1], plate.lower_x[k]},
         {plate.upper_y[k], plate.upper_y[k + 1], plate.lower_y[k + 1], plate.lower_y[k]}},
        albedo_[i]);
  }
}

void TilePainter::paint_view(const Tile& tile, const CameraView& view, int n, float weight) {
  find_candidates(tile, view);
  find_plates(tile, view, n);
  light_candidates(tile, n);
  const auto un = static_cast<std::size_t>(n);
  const std::size_t columns = static_cast<std::size_t>(tile.width + 2 * radius_px_) * un;
  const std::size_t rows = static_cast<std::size_t>(tile.height + 2 * radius_px_) * un;
  const std::size_t phase = columns / un;
  for (RayRow* rays : {&upper_, &lower_, &centre_}) rays->resize(columns + 1);
  for (auto* values : {&nearness_, &background_, &albedo_, &light_}) values->resize(columns);
  seen_.resize(columns);
  const auto share_at = [&](double row) {
    const double y_px = tile.y0 - radius_px_ + row / n - 0.5;
    return static_cast<float>((y_px - band_first_px_) /
                              std::max(band_last_px_ - band_first_px_, 1.0));
  };
  corner_rays(tile, n, 0, lower_);
  for (Plate& plate : plates_) plate_corners(plate, share_at(0));
  for (std::size_t row = 0; row < rows; ++row) {
    std::swap(upper_, lower_);
    corner_rays(tile, n, row + 1, lower_);
    for (std::size_t i = 0; i < columns; ++i) {
      centre_.x[i] = 0.25F * (upper_.x[i] + upper_.x[i + 1] + lower_.x[i] + lower_.x[i + 1]);
      centre_.y[i] = 0.25F * (upper_.y[i] + upper_.y[i + 1] + lower_.y[i] + lower_.y[i + 1]);
      centre_.z[i] = 0.25F * (upper_.z[i] + upper_.z[i + 1] + lower_.z[i] + lower_.z[i + 1]);
    }
    const float share = share_at(static_cast<double>(row) + 0.5);
    choose_surfaces(columns, share);
    paint_surfaces(row, columns, n, share);
    std::copy_n(background_.begin(), columns, albedo_.begin());
    const float lower_share = share_at(static_cast<double>(row) + 1.0);
    for (Plate& plate : plates_) paint_plate(plate, row, lower_share);
    float* out = canvas_.data() + row * columns;
    for (std::size_t p = 0; p < un; ++p) {
      for (std::size_t i = 0; i < phase; ++i) {
        out[p * phase + i] += weight * albedo_[i * un + p] * light_[i * un + p];
      }
    }
  }
}

void TilePainter::paint(const Tile& tile, const std::vector<CameraView>& views,
                        double band_first_px, double band_last_px, const PointSpread& spread,
                        IrradianceImage& out) {
  band_first_px_ = band_first_px;
  band_last_px_ = band_last_px;
  const int n = spread.oversampling();
  const auto un = static_cast<std::size_t>(n);
  const std::size_t phase = static_cast<std::size_t>(tile.width + 2 * radius_px_);
  const std::size_t rows = static_cast<std::size_t>(tile.height + 2 * radius_px_) * un;
  canvas_.assign(rows * phase * un, 0.0F);
  for (const CameraView& view : views) {
    paint_view(tile, view, n, 1.0F / static_cast<float>(views.size()));
  }
  const auto width = static_cast<std::size_t>(tile.width);
  half_reduced_.resize(rows * width);
  for (std::size_t row = 0; row < rows; ++row) {
    spread.reduce_row(canvas_.data() + row * phase * un, phase, width,
                      half_reduced_.data() + row * width);
  }
  for (int y = 0; y < tile.height; ++y) {
    float* pixels = out.values.data() +
                    static_cast<std::size_t>(tile.y0 + y) * static_cast<std::size_t>(out.width_px) +
                    static_cast<std::size_t>(tile.x0);
    spread.reduce_column(half_reduced_.data() + static_cast<std::size_t>(y) * un * width, width,
                         width, pixels);
  }
}

}  // namespace waymark::simulator
