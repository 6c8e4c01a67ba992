#include "core/detect/quad_fitter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace waymark {
namespace {

using Eigen::Vector2d;

/// Dark where `inside`, drawn with 8×8 samples per pixel.
GrayImage drawing(const std::function<bool(const Vector2d&)>& inside) {
  constexpr int kSamples = 8;
  GrayImage image(200, 160);
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = 0; x < image.width_px; ++x) {
      int dark = 0;
      for (int i = 0; i < kSamples * kSamples; ++i) {
        const Vector2d at(x - 0.5 + (i % kSamples + 0.5) / kSamples,
                          y - 0.5 + (static_cast<double>(i / kSamples) + 0.5) / kSamples);
        if (inside(at)) ++dark;
      }
      image.row(y)[x] = static_cast<std::uint8_t>(220 - 180 * dark / (kSamples * kSamples));
    }
  }
  return image;
}

bool is_inside(const ImageCorners& quad, const Vector2d& at) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector2d side = quad[(i + 1) % 4] - quad[i];
    const Vector2d to = at - quad[i];
    if (side.x() * to.y() - side.y() * to.x() < 0) return false;
  }
  return true;
}

GrayImage drawn_quad(const ImageCorners& quad) {
  return drawing([&](const Vector2d& at) { return is_inside(quad, at); });
}

/// A rectangle about the image's middle, clockwise.
ImageCorners rectangle(double width, double height, double turn_rad) {
  const Vector2d right(std::cos(turn_rad), std::sin(turn_rad));
  const Vector2d down(-right.y(), right.x());
  const Vector2d middle(100.3, 80.1);
  const auto corner = [&](double x, double y) -> Vector2d {
    return middle + 0.5 * x * width * right + 0.5 * y * height * down;
  };
  return {corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)};
}

std::vector<ImageCorners> quads_in(const GrayImage& image, double min_side_px = 12) {
  ContrastGates gates;
  TileThresholds thresholds;
  thresholds.measure(image.view(), gates);
  DarkPixels dark;
  dark.find(image.view(), thresholds, image.width_px);
  BorderFollower follower;
  follower.begin(dark);
  std::vector<ImageCorners> quads;
  for (auto border = follower.next(); !border.empty(); border = follower.next()) {
    const auto quad = fit_quad(image.view(), thresholds, border, min_side_px);
    if (quad) quads.push_back(*quad);
  }
  return quads;
}

/// Largest distance of corners, whichever of `found` is the first.
double largest_error_px(const ImageCorners& found, const ImageCorners& truth) {
  double least = 1e9;
  for (std::size_t turn = 0; turn < 4; ++turn) {
    double largest = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      largest = std::max(largest, (found[(i + turn) % 4] - truth[i]).norm());
    }
    least = std::min(least, largest);
  }
  return least;
}

TEST(QuadFitter, FindsSquaresAtAnyTurnAndSize) {
  for (const double side_px : {16.0, 30.0, 100.0}) {
    for (double turn = 0; turn < 1.6; turn += 0.13) {
      const ImageCorners truth = rectangle(side_px, side_px, turn);
      const auto quads = quads_in(drawn_quad(truth));
      ASSERT_EQ(quads.size(), 1U) << side_px << ' ' << turn;
      EXPECT_LT(largest_error_px(quads[0], truth), 0.4) << side_px << ' ' << turn;
    }
  }
}

TEST(QuadFitter, FindsSlenderOnesSeenAslant) {
  for (double turn = 0; turn < 3.2; turn += 0.17) {
    ImageCorners truth = rectangle(90, 14, turn);
    // A shear along the long sides.
    const Vector2d along = (truth[1] - truth[0]).normalized();
    truth[0] += 12 * along;
    truth[1] += 12 * along;
    const auto quads = quads_in(drawn_quad(truth));
    ASSERT_EQ(quads.size(), 1U) << turn;
    EXPECT_LT(largest_error_px(quads[0], truth), 1.2) << turn;
  }
}

TEST(QuadFitter, FindsTrapezoids) {
  const ImageCorners truth{{{70, 50}, {110, 45}, {150, 120}, {40, 110}}};
  const auto quads = quads_in(drawn_quad(truth));
  ASSERT_EQ(quads.size(), 1U);
  EXPECT_LT(largest_error_px(quads[0], truth), 0.4);
}

TEST(QuadFitter, PassesOverCirclesTrianglesAndLetters) {
  EXPECT_TRUE(quads_in(drawing([](const Vector2d& at) {
                return (at - Vector2d(100, 80)).norm() < 40;
              })).empty());
  EXPECT_TRUE(quads_in(drawing([](const Vector2d& at) {
                return at.y() > 30 && at.y() < 120 && std::abs(at.x() - 100) < 0.5 * (at.y() - 30);
              })).empty());
  EXPECT_TRUE(quads_in(drawing([](const Vector2d& at) {
                const bool stem = at.x() > 60 && at.x() < 80 && at.y() > 20 && at.y() < 140;
                return stem || (at.x() >= 80 && at.x() < 140 && at.y() > 120 && at.y() < 140);
              })).empty());
}

TEST(QuadFitter, PassesOverAHole) {
  const ImageCorners outer = rectangle(150, 130, 0.1);
  const ImageCorners inner = rectangle(40, 40, 0.3);
  const auto quads = quads_in(
      drawing([&](const Vector2d& at) { return is_inside(outer, at) && !is_inside(inner, at); }));
  ASSERT_EQ(quads.size(), 1U);
  EXPECT_LT(largest_error_px(quads[0], outer), 0.4);
}

TEST(QuadFitter, PassesOverWhatIsTooSmall) {
  const GrayImage image = drawn_quad(rectangle(30, 30, 0.2));
  EXPECT_EQ(quads_in(image, 29).size(), 1U);
  EXPECT_TRUE(quads_in(image, 31).empty());
}

}  // namespace
}  // namespace waymark
