#include "simulator/marker_print.h"

#include <algorithm>
#include <cmath>

#include "core/marker/marker_bits.h"

namespace waymark::simulator {
namespace {

/// Marks cells beyond the plate; no albedo is negative.
constexpr float kOutside = -1.0F;

/// Convex polygon of a footprint that is clipped by two pairs of parallel lines: 4 + 4 corners at
/// most.
struct Polygon {
  std::array<float, 12> x, y;
  int count = 0;

  void add(float px, float py) {
    x[static_cast<std::size_t>(count)] = px;
    y[static_cast<std::size_t>(count)] = py;
    ++count;
  }
};

/// The part with sign · (coordinate − bound) ≥ 0, where the coordinate is x or y
/// (Sutherland–Hodgman).
template <bool kAlongX>
Polygon clipped(const Polygon& in, float bound, float sign) {
  Polygon out;
  for (int i = 0; i < in.count; ++i) {
    const auto a = static_cast<std::size_t>(i);
    const auto b = static_cast<std::size_t>(i + 1 < in.count ? i + 1 : 0);
    const float da = sign * ((kAlongX ? in.x[a] : in.y[a]) - bound);
    const float db = sign * ((kAlongX ? in.x[b] : in.y[b]) - bound);
    if (da >= 0) out.add(in.x[a], in.y[a]);
    if ((da >= 0) != (db >= 0)) {
      const float t = da / (da - db);
      out.add(in.x[a] + t * (in.x[b] - in.x[a]), in.y[a] + t * (in.y[b] - in.y[a]));
    }
  }
  return out;
}

float area(const Polygon& p) {
  float twice = 0;
  for (int i = 2; i < p.count; ++i) {
    const auto a = static_cast<std::size_t>(i - 1);
    const auto b = static_cast<std::size_t>(i);
    twice += (p.x[a] - p.x[0]) * (p.y[b] - p.y[0]) - (p.x[b] - p.x[0]) * (p.y[a] - p.y[0]);
  }
  return 0.5F * std::abs(twice);
}

int floor_to_int(float value) {
  const int truncated = static_cast<int>(value);
  return truncated - (value < static_cast<float>(truncated) ? 1 : 0);
}

}  // namespace

MarkerPrint::MarkerPrint(const MarkerId& id, float black_albedo, float white_albedo) {
  const MarkerBits bits = marker_bits(id);
  square_ = bits.cells;
  side_ = bits.all_cells() + 2;
  const auto row_length = static_cast<std::size_t>(side_ + 2);
  albedo_.assign(row_length * row_length, kOutside);
  for (int y = 0; y < side_; ++y) {
    for (int x = 0; x < side_; ++x) {
      const bool margin = x == 0 || y == 0 || x == side_ - 1 || y == side_ - 1;
      const int row = y - 1 - bits.outside;
      const int column = x - 1 - bits.outside;
      const bool black =
          !margin && !bits.is_white(row, column) && bits.kind(row, column) != CellKind::nothing;
      albedo_[static_cast<std::size_t>(y + 1) * row_length + static_cast<std::size_t>(x + 1)] =
          black ? black_albedo : white_albedo;
    }
  }
}

float MarkerPrint::albedo(const Footprint& footprint, float background) const {
  const auto& [x, y] = footprint;
  const float low_x = std::min(std::min(x[0], x[1]), std::min(x[2], x[3]));
  const float high_x = std::max(std::max(x[0], x[1]), std::max(x[2], x[3]));
  const float low_y = std::min(std::min(y[0], y[1]), std::min(y[2], y[3]));
  const float high_y = std::max(std::max(y[0], y[1]), std::max(y[2], y[3]));
  const auto side = static_cast<float>(side_);
  if (!(high_x > 0 && high_y > 0 && low_x < side && low_y < side)) return background;
  const int first_x = std::max(floor_to_int(low_x), -1);
  const int last_x = std::min(floor_to_int(high_x), side_);
  const int first_y = std::max(floor_to_int(low_y), -1);
  const int last_y = std::min(floor_to_int(high_y), side_);
  const float first = cell(first_x, first_y);
  bool one_colour = true;
  for (int cy = first_y; cy <= last_y; ++cy) {
    for (int cx = first_x; cx <= last_x; ++cx) one_colour &= cell(cx, cy) == first;
  }
  if (one_colour) return first == kOutside ? background : first;
  return clipped_average(footprint, first_x, last_x, first_y, last_y, background);
}

float MarkerPrint::clipped_average(const Footprint& footprint, int first_x, int last_x, int first_y,
                                   int last_y, float background) const {
  Polygon whole;
  for (std::size_t i = 0; i < 4; ++i) whole.add(footprint.x[i], footprint.y[i]);
  const float whole_area = area(whole);
  float covered = 0;
  float sum = 0;
  Polygon rest = whole;
  for (int cx = std::max(first_x, 0); cx <= std::min(last_x, side_ - 1); ++cx) {
    Polygon column = first_x < cx ? clipped<true>(rest, static_cast<float>(cx), 1) : rest;
    rest = column;
    if (cx < last_x) column = clipped<true>(column, static_cast<float>(cx + 1), -1);
    for (int cy = std::max(first_y, 0); cy <= std::min(last_y, side_ - 1); ++cy) {
      Polygon part = first_y < cy ? clipped<false>(column, static_cast<float>(cy), 1) : column;
      if (cy < last_y) part = clipped<false>(part, static_cast<float>(cy + 1), -1);
      const float part_area = area(part);
      covered += part_area;
      sum += part_area * cell(cx, cy);
    }
  }
  if (!(whole_area > 0)) return background;
  return (sum + std::max(0.0F, whole_area - covered) * background) / whole_area;
}

}  // namespace waymark::simulator
