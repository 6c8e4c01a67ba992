#pragma once

#include <cstdint>
#include <vector>

#include "core/capture/gray_image.h"
#include "core/detect/contrast_gates.h"

namespace waymark {

/// Where an image is dark: a threshold for every tile of 4×4 pixels between the darkest and the
/// brightest of the 3×3 tiles around it (as libapriltag does; Wang and Olson, "AprilTag 2", IROS
/// 2016, section IV-A), at five eighths of the way: blur, and sensors that encode light, let light
/// run into thin dark lines, so that half way breaks small and slanted markers' borders. Tiles
/// without contrast have none; what counts as contrast, ContrastGates say. Keeps its memory from
/// image to image.
class TileThresholds {
 public:
  static constexpr int kTilePx = 4;
  /// Stands for none: no pixel is darker than that.
  static constexpr std::uint8_t kNone = 0;

  /// Looks at the tiles of an image with at least `kTilePx` columns and rows (checked).
  void look_at(const GrayView& image);
  /// Adds what every ninth tile's surroundings show to what the image's noise is judged by.
  void add_places_to(ContrastGates& gates) const;
  /// Gives every tile with contrast its threshold.
  void decide(const ContrastGates& gates);
  /// All of this: by the image's own noise, which `gates` tell from then on.
  void measure(const GrayView& image, ContrastGates& gates);

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  /// Thresholds of a row of tiles: pixels below are dark.
  [[nodiscard]] const std::uint8_t* row(int tile_row) const {
    return thresholds_.data() + index(tile_row);
  }
  [[nodiscard]] std::uint8_t at_pixel(int x, int y) const { return row(y / kTilePx)[x / kTilePx]; }
  /// Half way between the darkest and brightest pixel near a pixel's tile, whatever their contrast.
  [[nodiscard]] std::uint8_t middle_at_pixel(int x, int y) const;

 private:
  void measure_tiles(const GrayView& image);
  void widen();
  [[nodiscard]] std::size_t index(int tile_row) const {
    return static_cast<std::size_t>(tile_row) * static_cast<std::size_t>(columns_);
  }

  int columns_ = 0;
  int rows_ = 0;
  // By tile, row by row.
  std::vector<std::uint8_t> darkest_;
  std::vector<std::uint8_t> brightest_;
  std::vector<std::uint8_t> darkest_near_;
  std::vector<std::uint8_t> brightest_near_;
  std::vector<std::uint8_t> thresholds_;
  // Of one row of pixels, or tiles.
  std::vector<std::uint8_t> low_;
  std::vector<std::uint8_t> high_;
};

}  // namespace waymark
