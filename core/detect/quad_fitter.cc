#include "core/detect/quad_fitter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/detect/border_corners.h"
#include "core/geometry/line2.h"

namespace waymark {
namespace {

using Eigen::Vector2d;
using Border = std::span<const Pixel>;

Vector2d place_of(const Pixel& pixel) { return {pixel.x, pixel.y}; }

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

using Corners = BorderCorners;

using Lines = std::array<Line2, 4>;

/// Sums of a straight line's fit, about an origin near its points.
class LineSums {
 public:
  explicit LineSums(const Vector2d& origin) : origin_(origin) {}
  void add(const Vector2d& point) {
    const Vector2d p = point - origin_;
    ++count_;
    sum_ += p;
    xx_ += p.x() * p.x();
    xy_ += p.x() * p.y();
    yy_ += p.y() * p.y();
  }
  [[nodiscard]] int count() const { return count_; }

  /// The line with the least squared distances; along `towards`.
  [[nodiscard]] Line2 line(const Vector2d& towards) const {
    const Vector2d mean = sum_ / count_;
    const double xx = xx_ / count_ - mean.x() * mean.x();
    const double xy = xy_ / count_ - mean.x() * mean.y();
    const double yy = yy_ / count_ - mean.y() * mean.y();
    // Half the angle of the second moments' direction.
    const double difference = xx - yy;
    const double length = std::sqrt(difference * difference + 4 * xy * xy);
    Vector2d direction = difference > 0 ? Vector2d(difference + length, 2 * xy)
                                        : Vector2d(2 * xy, length - difference);
    if (direction.squaredNorm() < 1e-12) direction = towards;
    direction.normalize();
    if (direction.dot(towards) < 0) direction = -direction;
    return {origin_ + mean, direction};
  }

  /// Of the points about their line, RMS.
  [[nodiscard]] double scatter() const {
    const Vector2d mean = sum_ / count_;
    const double xx = xx_ / count_ - mean.x() * mean.x();
    const double xy = xy_ / count_ - mean.x() * mean.y();
    const double yy = yy_ / count_ - mean.y() * mean.y();
    return std::sqrt(
        std::max(0.0, 0.5 * (xx + yy - std::sqrt((xx - yy) * (xx - yy) + 4 * xy * xy))));
  }

 private:
  Vector2d origin_;
  Vector2d sum_ = Vector2d::Zero();
  double xx_ = 0;
  double xy_ = 0;
  double yy_ = 0;
  int count_ = 0;
};

/// Corner i is where sides i − 1 and i meet.
std::optional<ImageCorners> intersections(const Lines& lines) {
  constexpr double kLeastSine = 0.05;
  ImageCorners corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto corner = intersection(lines[(i + 3) % 4], lines[i], kLeastSine);
    if (!corner) return std::nullopt;
    corners[i] = *corner;
  }
  return corners;
}

/// Share of a side that is left without an eighth at either end, where corners are rounded.
constexpr double kUntrimmed = 0.75;

/// A stretch of the border, cyclic, without what is rounded at its ends.
struct Stretch {
  std::size_t first = 0;
  std::size_t count = 0;
  std::size_t stride = 1;
};

Stretch side_between(std::size_t from, std::size_t to, std::size_t all) {
  constexpr std::size_t kMostSamples = 64;
  const std::size_t length = (to + all - from) % all;
  std::size_t trim = std::max<std::size_t>(1, length / 8);
  if (length < 4) trim = 0;
  const std::size_t count = length + 1 - 2 * trim;
  return {from + trim, count, 1 + count / kMostSamples};
}

template <typename Use>
void for_each_pixel(Border border, const Stretch& stretch, const Use& use) {
  for (std::size_t i = 0; i < stretch.count; i += stretch.stride) {
    std::size_t index = stretch.first + i;
    if (index >= border.size()) index -= border.size();
    use(border[index]);
  }
}

constexpr int kFewestPoints = 2;

/// Lines through the pixels near the sides between corners. A border may go astray where a marker's
/// own is thin and broken.
std::optional<Lines> lines_through_pixels(Border border, const Corners& corners) {
  constexpr double kNearPx = 1.5;
  constexpr double kNearShare = 0.06;  // of the side: corners are rough
  constexpr double kMostScatterPx = 0.7;
  constexpr double kMostScatterShare = 0.01;  // of the side: lenses bend it
  Lines lines;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t next = corners[(i + 1) % 4];
    const Vector2d start = place_of(border[corners[i]]);
    const Vector2d side = place_of(border[next]) - start;
    const double length = side.norm();
    const double near = (kNearPx + kNearShare * length) * length;
    LineSums sums(start);
    for_each_pixel(border, side_between(corners[i], next, border.size()), [&](const Pixel& pixel) {
      const Vector2d place = place_of(pixel);
      if (std::abs(cross(side, place - start)) < near) sums.add(place);
    });
    if (sums.count() < kFewestPoints) return std::nullopt;
    if (sums.scatter() > kMostScatterPx + kMostScatterShare * length) return std::nullopt;
    lines[i] = sums.line(side);
  }
  return lines;
}

/// The border's pixel nearest to a point, looked for within `reach` of an index.
std::size_t nearest_index(Border border, const Vector2d& point, std::size_t around,
                          std::size_t reach) {
  std::size_t best = around;
  double least = (place_of(border[around]) - point).squaredNorm();
  for (std::size_t i = 0; i <= 2 * reach; ++i) {
    const std::size_t index = (around + border.size() - reach + i) % border.size();
    const double squared = (place_of(border[index]) - point).squaredNorm();
    if (squared >= least) continue;
    least = squared;
    best = index;
  }
  return best;
}

/// Where lines through the pixels meet divides the border better than far points do.
std::optional<Corners> divided_again(Border border, const Corners& corners,
                                     const ImageCorners& meeting) {
  Corners better;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t all = border.size();
    const std::size_t before = (corners[i] + all - corners[(i + 3) % 4]) % all;
    const std::size_t after = (corners[(i + 1) % 4] + all - corners[i]) % all;
    better[i] = nearest_index(border, meeting[i], corners[i], std::max(before, after) / 3);
  }
  std::size_t sum = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t length = (better[(i + 1) % 4] + border.size() - better[i]) % border.size();
    if (length < 2) return std::nullopt;
    sum += length;
  }
  if (sum != border.size()) return std::nullopt;
  return better;
}

/// Where the image is half way between dark and light, outward of a dark pixel at the border, in
/// one direction.
class Crossing {
 public:
  Crossing(const GrayView& image, const TileThresholds& thresholds, const Vector2d& outward)
      : image_(image), thresholds_(thresholds) {
    if (std::abs(outward.x()) > std::abs(outward.y())) {
      step_x_ = outward.x() > 0 ? 1 : -1;
    } else {
      step_y_ = outward.y() > 0 ? 1 : -1;
    }
  }

  [[nodiscard]] std::optional<Vector2d> from(const Pixel& pixel) const {
    constexpr int kInside = 1;  // thresholds lie above the middle
    constexpr int kOutside = 2;
    const int middle = thresholds_.middle_at_pixel(pixel.x, pixel.y);
    int before = 255;
    for (int i = -kInside; i <= kOutside; ++i) {
      const int x = pixel.x + i * step_x_;
      const int y = pixel.y + i * step_y_;
      if (x < 0 || y < 0 || x >= image_.width_px || y >= image_.height_px) return std::nullopt;
      const int here = image_.row(y)[x];
      if (before < middle && here >= middle) {
        const double outward = i - 1 + static_cast<double>(middle - before) / (here - before);
        return Vector2d(pixel.x + outward * step_x_, pixel.y + outward * step_y_);
      }
      before = here;
    }
    return std::nullopt;
  }

 private:
  const GrayView& image_;
  const TileThresholds& thresholds_;
  int step_x_ = 0;
  int step_y_ = 0;
};

/// A side through the threshold's crossings near `rough`; those off the first fit's line are left
/// out of a second. nullopt where they cover too little of the side.
std::optional<Line2> line_through_crossings(Border border, const Stretch& stretch,
                                            const Crossing& crossing, const Line2& rough,
                                            double length) {
  constexpr double kNearPx = 1.5;
  constexpr double kNearShare = 0.02;  // of the side: lenses bend it
  constexpr double kLeastGatePx = 0.5;
  constexpr double kGateSigmas = 2.5;
  constexpr double kLeastCovered = 0.55;  // of the side
  std::array<Vector2d, 160> points;
  std::size_t count = 0;
  LineSums all(rough.point);
  for_each_pixel(border, stretch, [&](const Pixel& pixel) {
    const auto point = crossing.from(pixel);
    if (!point || count == points.size()) return;
    if (std::abs(cross(rough.direction, *point - rough.point)) > kNearPx + kNearShare * length)
      return;
    points[count++] = *point;
    all.add(*point);
  });
  if (all.count() < kFewestPoints) return std::nullopt;
  const Line2 first = all.line(rough.direction);
  double squares = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double off = cross(first.direction, points[i] - first.point);
    squares += off * off;
  }
  const double gate =
      std::max(kLeastGatePx, kGateSigmas * std::sqrt(squares / static_cast<double>(count)));
  LineSums near(rough.point);
  for (std::size_t i = 0; i < count; ++i) {
    if (std::abs(cross(first.direction, points[i] - first.point)) <= gate) near.add(points[i]);
  }
  // A pixel of the border is a step along the greater of the direction's parts.
  const double pixels = length * rough.direction.cwiseAbs().maxCoeff();
  if (near.count() < kFewestPoints ||
      near.count() * static_cast<double>(stretch.stride) < kLeastCovered * kUntrimmed * pixels) {
    return std::nullopt;
  }
  return near.line(rough.direction);
}

std::optional<Lines> lines_through_crossings(const GrayView& image,
                                             const TileThresholds& thresholds, Border border,
                                             const Corners& corners, const Lines& rough) {
  Lines lines;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t next = corners[(i + 1) % 4];
    const Vector2d start = place_of(border[corners[i]]);
    const Vector2d towards = place_of(border[next]) - start;
    // The border runs clockwise: the light is on its left.
    const Crossing crossing(image, thresholds, Vector2d(towards.y(), -towards.x()));
    const auto line = line_through_crossings(border, side_between(corners[i], next, border.size()),
                                             crossing, rough[i], towards.norm());
    if (!line) return std::nullopt;
    lines[i] = *line;
  }
  return lines;
}

/// Whether corners turn right everywhere, with sides of some length.
bool is_sound(const ImageCorners& corners, double min_side_px) {
  constexpr double kShortestSidePx = 2.5;
  constexpr double kLeastSine = 0.08;
  double perimeter = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector2d in = corners[i] - corners[(i + 3) % 4];
    const Vector2d out = corners[(i + 1) % 4] - corners[i];
    const double length = out.norm();
    if (!(length >= kShortestSidePx)) return false;
    if (!(cross(in, out) > kLeastSine * in.norm() * length)) return false;
    perimeter += length;
  }
  return perimeter >= 4 * min_side_px;
}

}  // namespace

std::optional<ImageCorners> fit_quad(const GrayView& image, const TileThresholds& thresholds,
                                     Border border, double min_side_px) {
  const auto far = find_border_corners(border, min_side_px);
  if (!far) return std::nullopt;
  const auto rough = lines_through_pixels(border, *far);
  if (!rough) return std::nullopt;
  const auto meeting = intersections(*rough);
  if (!meeting) return std::nullopt;
  const auto corners = divided_again(border, *far, *meeting);
  if (!corners) return std::nullopt;
  const auto lines = lines_through_crossings(image, thresholds, border, *corners, *rough);
  if (!lines) return std::nullopt;
  const auto quad = intersections(*lines);
  if (!quad || !is_sound(*quad, min_side_px)) return std::nullopt;
  return quad;
}

}  // namespace waymark
