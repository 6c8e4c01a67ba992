#include "core/detect/side_search.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace waymark {
namespace {

constexpr int kProfiles = 16;
/// A step (grey levels over 2 px) below this is no edge but noise.
constexpr double kMinStepGrey = 8;
/// Profiles whose step lies within this (px) of the line agree with it.
constexpr double kAgreementPx = 0.75;

/// Where one profile across the side has its steepest step.
struct Step {
  double place;
  double outside_px;
  double black_grey;
  double white_grey;
};

std::optional<double> interpolated_grey(const GrayView& image, const Eigen::Vector2d& pixel) {
  const double x = std::floor(pixel.x());
  const double y = std::floor(pixel.y());
  if (!(x >= 0 && y >= 0 && x + 1 < image.width_px && y + 1 < image.height_px)) return std::nullopt;
  const double dx = pixel.x() - x;
  const double dy = pixel.y() - y;
  const std::uint8_t* upper = image.row(static_cast<int>(y)) + static_cast<int>(x);
  const std::uint8_t* lower = upper + image.stride_bytes;
  return (1 - dy) * ((1 - dx) * upper[0] + dx * upper[1]) +
         dy * ((1 - dx) * lower[0] + dx * lower[1]);
}

/// The steepest rise from inside to outside along a profile sampled once per pixel.
std::optional<Step> steepest_step(const GrayView& image, const ImageSide& side, double place,
                                  double reach_px) {
  constexpr int kMaxSamples = 33;
  const int half = std::clamp(static_cast<int>(std::ceil(reach_px)) + 1, 2, kMaxSamples / 2);
  std::array<double, kMaxSamples> grey;
  const Eigen::Vector2d middle = side.point_px(place);
  for (int i = -half; i <= half; ++i) {
    const auto sample = interpolated_grey(image, middle + i * side.outward());
    if (!sample) return std::nullopt;
    grey[static_cast<std::size_t>(i + half)] = *sample;
  }
  const auto rise = [&](int i) {
    const auto at = static_cast<std::size_t>(i + half);
    return grey[at + 1] - grey[at - 1];
  };
  int best = 1 - half;
  for (int i = 1 - half; i < half; ++i) {
    if (rise(i) > rise(best)) best = i;
  }
  if (rise(best) < kMinStepGrey) return std::nullopt;
  double fraction = 0;  // vertex of the parabola through the rise and its neighbours
  if (best > 1 - half && best < half - 1) {
    const double before = rise(best - 1);
    const double after = rise(best + 1);
    const double curvature = 2 * rise(best) - before - after;
    if (curvature > 0) fraction = std::clamp(0.5 * (after - before) / curvature, -0.5, 0.5);
  }
  const auto inside = static_cast<std::size_t>(std::max(best - 2, -half) + half);
  const auto outside = static_cast<std::size_t>(std::min(best + 2, half) + half);
  return Step{place, best + fraction, grey[inside], grey[outside]};
}

struct Line {
  double start = 0;  ///< outside_px at place 0
  double end = 0;    ///< at place 1

  [[nodiscard]] double at(double place) const { return start + (end - start) * place; }
};

/// Least-squares line through the steps that agree with `line`; nullopt for fewer than two places.
std::optional<Line> fit_to_agreeing(const std::array<Step, kProfiles>& steps, std::size_t count,
                                    const Line& line) {
  double n = 0;
  double sx = 0;
  double sy = 0;
  double sxx = 0;
  double sxy = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Step& step = steps[i];
    if (std::abs(step.outside_px - line.at(step.place)) > kAgreementPx) continue;
    n += 1;
    sx += step.place;
    sy += step.outside_px;
    sxx += step.place * step.place;
    sxy += step.place * step.outside_px;
  }
  const double determinant = n * sxx - sx * sx;
  if (determinant < 1e-6) return std::nullopt;
  const double slope = (n * sxy - sx * sy) / determinant;
  const double start = (sy - slope * sx) / n;
  return Line{start, start + slope};
}

std::size_t count_agreeing(const std::array<Step, kProfiles>& steps, std::size_t count,
                           const Line& line) {
  return static_cast<std::size_t>(std::count_if(
      steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(count), [&](const Step& step) {
        return std::abs(step.outside_px - line.at(step.place)) <= kAgreementPx;
      }));
}

/// The line through two steps that most steps agree with; of equal ones the first.
Line line_of_most(const std::array<Step, kProfiles>& steps, std::size_t count) {
  Line best;
  std::size_t best_agreeing = 0;
  for (std::size_t i = 0; i + 1 < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      const double slope =
          (steps[j].outside_px - steps[i].outside_px) / (steps[j].place - steps[i].place);
      const double start = steps[i].outside_px - slope * steps[i].place;
      const Line line{start, start + slope};
      const std::size_t agreeing = count_agreeing(steps, count, line);
      if (agreeing > best_agreeing) {
        best_agreeing = agreeing;
        best = line;
      }
    }
  }
  return best;
}

}  // namespace

std::optional<FoundSide> search_side(const GrayView& image, const ImageSide& side,
                                     double reach_px) {
  std::array<Step, kProfiles> steps;
  std::size_t count = 0;
  const double margin = std::clamp(2.0 / side.length_px(), 0.08, 0.3);
  for (int i = 0; i < kProfiles; ++i) {
    const double place = margin + (1 - 2 * margin) * i / (kProfiles - 1);
    if (const auto step = steepest_step(image, side, place, reach_px)) steps[count++] = *step;
  }
  constexpr std::size_t kMinAgreeing = kProfiles / 2;
  if (count < kMinAgreeing) return std::nullopt;
  const Line seed = line_of_most(steps, count);
  const auto line = fit_to_agreeing(steps, count, seed);
  if (!line || count_agreeing(steps, count, *line) < kMinAgreeing) return std::nullopt;

  FoundSide found;
  found.shift_px = {line->start, line->end};
  double agreeing = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (std::abs(steps[i].outside_px - line->at(steps[i].place)) > kAgreementPx) continue;
    agreeing += 1;
    found.black_grey += steps[i].black_grey;
    found.white_grey += steps[i].white_grey;
  }
  found.black_grey /= agreeing;
  found.white_grey /= agreeing;
  return found;
}

}  // namespace waymark
