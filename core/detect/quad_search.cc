#include "core/detect/quad_search.h"

#include <algorithm>
#include <array>

#include "core/base/check.h"
#include "core/detect/quad_fitter.h"

namespace waymark {
namespace {

bool has_tiles(const GrayView& image) {
  return std::min(image.width_px, image.height_px) >= TileThresholds::kTilePx;
}

/// Places that tell of noise have as many pixels as 3×3 tiles, a vector register wide.
constexpr int kPlaceWidth_px = 16;
constexpr int kPlaceHeight_px = 9;

void add_place(const GrayView& place, ContrastGates& gates) {
  std::array<std::uint8_t, kPlaceWidth_px> low;
  std::array<std::uint8_t, kPlaceWidth_px> high;
  low.fill(255);
  high.fill(0);
  for (int y = 0; y < kPlaceHeight_px; ++y) {
    const std::uint8_t* const pixels = place.row(y);
    for (std::size_t x = 0; x < kPlaceWidth_px; ++x) {
      low[x] = std::min(low[x], pixels[x]);
      high[x] = std::max(high[x], pixels[x]);
    }
  }
  gates.add(*std::min_element(low.begin(), low.end()), *std::max_element(high.begin(), high.end()));
}

}  // namespace

const char* QuadSearch::why_not(const GrayView& image) {
  if (image.data == nullptr) return "it has no pixels";
  if (image.stride_bytes < static_cast<std::size_t>(image.width_px)) return "its rows overlap";
  if (std::max(image.width_px, image.height_px) >= BorderFollower::kSizeLimitPx) {
    return "it is wider or higher than 32767 pixels";
  }
  return nullptr;
}

/// Noise of 3 grey levels or so; smoothing would only cost small markers their margins.
bool QuadSearch::is_noisy() const {
  constexpr int kNoisyGate = 32;
  return gates_.gate_grey() > kNoisyGate;
}

const std::vector<ImageCorners>& QuadSearch::find(const GrayView& image, double min_side_px) {
  WAYMARK_CHECK(why_not(image) == nullptr);
  quads_.clear();
  if (!has_tiles(image)) return quads_;
  GrayView searched = image;
  thresholds_.measure(image, gates_);
  if (is_noisy()) {
    searched = smoothing_.smoothed(image);
    thresholds_.measure(searched, gates_);
  }
  find_in(searched, image.width_px, min_side_px, Eigen::Vector2d::Zero());
  return quads_;
}

/// By places evenly over the image.
void QuadSearch::judge_noise(const GrayView& image, bool smoothed) {
  constexpr int kPlaces = 18;  // along either side
  const auto begin = [](int place, int length, int of_place) {
    return (length - of_place) * place / (kPlaces - 1);
  };
  for (int i = 0; i < kPlaces * kPlaces; ++i) {
    const ImageWindow window{begin(i % kPlaces, image.width_px, kPlaceWidth_px),
                             begin(i / kPlaces, image.height_px, kPlaceHeight_px), kPlaceWidth_px,
                             kPlaceHeight_px};
    const GrayView place = view_of(image, window);
    add_place(smoothed ? smoothing_.smoothed(place) : place, gates_);
  }
  gates_.settle();
}

const std::vector<ImageCorners>& QuadSearch::find(const GrayView& image, double min_side_px,
                                                  std::span<const ImageWindow> windows) {
  WAYMARK_CHECK(why_not(image) == nullptr);
  quads_.clear();
  // In an image that has no place, there is none for a marker either.
  if (image.width_px < kPlaceWidth_px || image.height_px < kPlaceHeight_px) return quads_;
  judge_noise(image, false);
  const bool noisy = is_noisy();
  if (noisy) judge_noise(image, true);
  for (const ImageWindow& wanted : windows) {
    const ImageWindow window = within(image, wanted, TileThresholds::kTilePx);
    if (std::min(window.width_px, window.height_px) < TileThresholds::kTilePx) continue;
    const GrayView part = view_of(image, window);
    const GrayView searched = noisy ? smoothing_.smoothed(part) : part;
    thresholds_.look_at(searched);
    thresholds_.decide(gates_);
    find_in(searched, image.width_px, min_side_px, {window.left_px, window.top_px});
  }
  return quads_;
}

/// Adds the quads of what the thresholds are of.
void QuadSearch::find_in(const GrayView& window, int row_px, double min_side_px,
                         const Eigen::Vector2d& origin) {
  dark_.find(window, thresholds_, row_px);
  borders_.begin(dark_);
  for (auto border = borders_.next(); !border.empty(); border = borders_.next()) {
    const auto quad = fit_quad(window, thresholds_, border, min_side_px);
    if (!quad) continue;
    quads_.push_back(*quad);
    for (Eigen::Vector2d& corner : quads_.back()) corner += origin;
  }
}

}  // namespace waymark
