#include "core/detect/border_corners.h"

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

/// Pixels evenly along a border.
class Samples {
 public:
  static constexpr std::size_t kMost = 48;

  explicit Samples(std::span<const Pixel> border) : stride_(1 + (border.size() - 1) / kMost) {
    for (std::size_t i = 0; i < border.size(); i += stride_) {
      x_[count_] = border[i].x;
      y_[count_] = border[i].y;
      ++count_;
    }
  }

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] std::size_t stride() const { return stride_; }
  [[nodiscard]] float x(std::size_t i) const { return x_[i]; }
  [[nodiscard]] float y(std::size_t i) const { return y_[i]; }

  /// Of the polygon, positive where it runs clockwise as the image shows it.
  [[nodiscard]] float area() const {
    // About the first sample, lest large numbers cancel.
    float twice = 0;
    for (std::size_t i = 1; i + 1 < count_; ++i) {
      twice += (x_[i] - x_[0]) * (y_[i + 1] - y_[0]) - (x_[i + 1] - x_[0]) * (y_[i] - y_[0]);
    }
    return 0.5F * twice;
  }

  /// The sample with the greatest value.
  template <typename Value>
  [[nodiscard]] std::size_t greatest(const Value& value) const {
    std::array<float, kMost> values;
    for (std::size_t i = 0; i < count_; ++i) values[i] = value(x_[i], y_[i]);
    return static_cast<std::size_t>(
        std::max_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count_)) -
        values.begin());
  }

  [[nodiscard]] std::size_t farthest_from(std::size_t from) const {
    const float ax = x_[from];
    const float ay = y_[from];
    return greatest([&](float x, float y) { return (x - ax) * (x - ax) + (y - ay) * (y - ay); });
  }

 private:
  std::size_t stride_;
  std::size_t count_ = 0;
  std::array<float, kMost> x_;
  std::array<float, kMost> y_;
};

/// A line from one pixel to another.
class Chord {
 public:
  Chord(const Pixel& from, const Pixel& to)
      : x_(from.x),
        y_(from.y),
        across_(static_cast<float>(to.x - from.x)),
        down_(static_cast<float>(to.y - from.y)),
        length_(std::sqrt(across_ * across_ + down_ * down_)),
        per_length_(1.0F / std::max(1.0F, length_)) {}

  [[nodiscard]] float length() const { return length_; }
  /// Steps of a border along it: diagonal ones count as one.
  [[nodiscard]] float steps() const { return std::max(std::abs(across_), std::abs(down_)); }
  /// Distance (px) to the left, where the light is.
  [[nodiscard]] float left_of(float x, float y) const {
    return (down_ * (x - x_) - across_ * (y - y_)) * per_length_;
  }

 private:
  float x_;
  float y_;
  float across_;
  float down_;
  float length_;
  float per_length_;
};

/// Two ends of the longest diagonal or side, what is farthest from their line, and what is farthest
/// outside these three's triangle; rising.
BorderCorners far_pixels(std::span<const Pixel> border, const Samples& samples) {
  const std::size_t a = samples.farthest_from(0);
  const std::size_t b = samples.farthest_from(a);
  const auto chord = [&](std::size_t from, std::size_t to) {
    return Chord(border[from * samples.stride()], border[to * samples.stride()]);
  };
  const Chord longest = chord(a, b);
  const std::size_t c =
      samples.greatest([&](float x, float y) { return std::abs(longest.left_of(x, y)); });
  std::array<std::size_t, 3> triangle{a, b, c};
  std::sort(triangle.begin(), triangle.end());  // clockwise, as the border runs
  const Chord first = chord(triangle[0], triangle[1]);
  const Chord second = chord(triangle[1], triangle[2]);
  const Chord third = chord(triangle[2], triangle[0]);
  const std::size_t d = samples.greatest([&](float x, float y) {
    return std::max(std::max(first.left_of(x, y), second.left_of(x, y)), third.left_of(x, y));
  });
  BorderCorners corners{a, b, c, d};
  std::sort(corners.begin(), corners.end());
  for (std::size_t& corner : corners) corner *= samples.stride();
  return corners;
}

/// Moves each corner between samples to where it is farthest from its neighbours' diagonal.
void move_between_samples(std::span<const Pixel> border, std::size_t stride,
                          BorderCorners& corners) {
  if (stride == 1) return;
  for (std::size_t i = 0; i < 4; ++i) {
    const Chord diagonal(border[corners[(i + 3) % 4]], border[corners[(i + 1) % 4]]);
    const std::size_t first = corners[i] + border.size() - stride + 1;
    float most = 0;
    for (std::size_t k = 0; k < 2 * stride - 1; ++k) {
      const std::size_t index = (first + k) % border.size();
      const float outside = diagonal.left_of(border[index].x, border[index].y);
      if (outside <= most) continue;
      most = outside;
      corners[i] = index;
    }
  }
  // One that was the first of all may have moved to the end.
  std::sort(corners.begin(), corners.end());
}

float quad_area(std::span<const Pixel> border, const BorderCorners& corners) {
  const auto& [a, b, c, d] = corners;
  return 0.5F * (static_cast<float>(border[c].x - border[a].x) *
                     static_cast<float>(border[d].y - border[b].y) -
                 static_cast<float>(border[d].x - border[b].x) *
                     static_cast<float>(border[c].y - border[a].y));
}

/// Whether the border runs along the sides for most of each.
bool keeps_to_sides(std::span<const Pixel> border, const Samples& samples,
                    const BorderCorners& corners, double min_side_px) {
  constexpr float kNearPx = 1.5F;
  constexpr float kNearShare = 0.06F;    // of the side: corners are rough, lenses bend
  constexpr float kLeastCovered = 0.5F;  // of the side
  float perimeter = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t from = corners[i];
    const std::size_t to = corners[(i + 1) % 4];
    if (from == to) return false;
    const Chord side(border[from], border[to]);
    const float near = kNearPx + kNearShare * side.length();
    const std::size_t last = to / samples.stride();
    std::size_t k = from / samples.stride();
    std::size_t covered = 0;
    while (k != last) {
      k = k + 1 < samples.count() ? k + 1 : 0;
      if (std::abs(side.left_of(samples.x(k), samples.y(k))) < near) ++covered;
    }
    if (static_cast<float>(covered * samples.stride()) < kLeastCovered * side.steps()) return false;
    perimeter += side.length();
  }
  // Pixels' middles lie half a pixel inside, and rounded corners farther.
  constexpr float kRoundedPx = 2;
  return perimeter > 4 * (static_cast<float>(min_side_px) - kRoundedPx);
}

}  // namespace

std::optional<BorderCorners> find_border_corners(std::span<const Pixel> border,
                                                 double min_side_px) {
  constexpr double kFewestSteps = 2;    // per px of the mean side: diagonal steps are 1.4 px long
  constexpr float kLeastShare = 0.72F;  // rounded corners of small markers; a circle has 0.64
  constexpr float kMostShare = 1.35F;
  if (static_cast<double>(border.size()) < kFewestSteps * min_side_px) return std::nullopt;
  const Samples samples(border);
  const float area = samples.area();
  if (!(area > 0)) return std::nullopt;
  BorderCorners corners = far_pixels(border, samples);
  move_between_samples(border, samples.stride(), corners);
  const float share = quad_area(border, corners) / area;
  if (!(share > kLeastShare && share < kMostShare)) return std::nullopt;
  if (!keeps_to_sides(border, samples, corners, min_side_px)) return std::nullopt;
  return corners;
}

}  // namespace waymark
