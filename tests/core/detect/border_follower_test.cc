#include "core/detect/border_follower.h"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <string>

namespace waymark {
namespace {

/// Dark where the rows have a '#'.
class Picture {
 public:
  explicit Picture(const std::vector<std::string>& rows)
      : image_(static_cast<int>(rows[0].size()), static_cast<int>(rows.size()), 200) {
    for (int y = 0; y < image_.height_px; ++y) {
      for (int x = 0; x < image_.width_px; ++x) {
        if (rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] == '#') {
          image_.row(y)[x] = 20;
        }
      }
    }
    ContrastGates gates;
    TileThresholds thresholds;
    thresholds.measure(image_.view(), gates);
    dark_.find(image_.view(), thresholds, image_.width_px);
  }

  [[nodiscard]] std::vector<std::vector<Pixel>> borders() const {
    BorderFollower follower;
    follower.begin(dark_);
    std::vector<std::vector<Pixel>> all;
    for (auto border = follower.next(); !border.empty(); border = follower.next()) {
      all.emplace_back(border.begin(), border.end());
    }
    return all;
  }

  [[nodiscard]] const DarkPixels& dark() const { return dark_; }

 private:
  GrayImage image_;
  DarkPixels dark_;
};

using Border = std::vector<Pixel>;

/// Twice the area within, positive when clockwise as the image shows it.
int turning(const Border& border) {
  int twice = 0;
  for (std::size_t i = 0; i < border.size(); ++i) {
    const Pixel& a = border[i];
    const Pixel& b = border[(i + 1) % border.size()];
    twice += a.x * b.y - b.x * a.y;
  }
  return twice;
}

TEST(BorderFollower, GoesRoundASquareClockwise) {
  const Picture picture({"........",  //
                         "..###...",  //
                         "..###...",  //
                         "..###...",  //
                         "........"});
  EXPECT_EQ(
      picture.borders(),
      (std::vector<Border>{{{2, 1}, {3, 1}, {4, 1}, {4, 2}, {4, 3}, {3, 3}, {2, 3}, {2, 2}}}));
}

TEST(BorderFollower, TakesDiagonalStepsWithinAnArea) {
  const Picture picture({"......",  //
                         "..#...",  //
                         ".###..",  //
                         "..#...",  //
                         "......"});
  EXPECT_EQ(picture.borders(), (std::vector<Border>{{{2, 1}, {3, 2}, {2, 3}, {1, 2}}}));
}

TEST(BorderFollower, AreasThatTouchAtACornerHaveABorderEach) {
  const Picture picture({"......",  //
                         ".##...",  //
                         ".##...",  //
                         "...##.",  //
                         "...##.",  //
                         "......"});
  const auto borders = picture.borders();
  ASSERT_EQ(borders.size(), 2U);
  EXPECT_EQ(borders[0].size(), 4U);
  EXPECT_EQ(borders[1].front(), (Pixel{3, 3}));
}

TEST(BorderFollower, APixelThatIsPassedTwiceComesTwice) {
  const Picture picture({"......",  //
                         ".###..",  //
                         "......",  //
                         "......"});
  EXPECT_EQ(picture.borders(), (std::vector<Border>{{{1, 1}, {2, 1}, {3, 1}, {2, 1}}}));
}

TEST(BorderFollower, ASinglePixelHasNone) {
  const Picture picture({".....", "..#..", ".....", "....."});
  EXPECT_TRUE(picture.borders().empty());
}

TEST(BorderFollower, LeavesOutWhatIsLongerThanAConvexBorder) {
  // A comb: 13 teeth of 24 pixels in an image of 2 · (27 + 27) = 108, so 128, pixels.
  std::vector<std::string> rows(27, std::string(27, '.'));
  for (int y = 1; y < 26; ++y) {
    for (int x = 1; x < 26; ++x) {
      if (y == 25 || x % 2 == 1)
        rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] = '#';
    }
  }
  EXPECT_TRUE(Picture(rows).borders().empty());
}

/// Numbers of 4-connected areas by pixel, 0 for light; how many pixels each has.
struct Areas {
  std::vector<int> of;
  std::vector<int> sizes{0};
};

Areas areas_of(const DarkPixels& dark) {
  const int width = dark.width_px();
  const int height = dark.height_px();
  Areas areas;
  areas.of.assign(static_cast<std::size_t>(width * height), 0);
  std::vector<std::pair<int, int>> open;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (!dark.is_dark(x, y) || areas.of[static_cast<std::size_t>(y * width + x)] != 0) continue;
      const int number = static_cast<int>(areas.sizes.size());
      areas.sizes.push_back(0);
      open.assign(1, {x, y});
      while (!open.empty()) {
        const auto [i, k] = open.back();
        open.pop_back();
        if (i < 0 || k < 0 || i >= width || k >= height || !dark.is_dark(i, k)) continue;
        int& of = areas.of[static_cast<std::size_t>(k * width + i)];
        if (of != 0) continue;
        of = number;
        ++areas.sizes.back();
        for (const auto& [dx, dy] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
          open.emplace_back(i + dx, k + dy);
        }
      }
    }
  }
  return areas;
}

TEST(BorderFollower, OfAnyPictureEveryAreaIsGoneRoundAndNoStepLeavesIt) {
  std::mt19937 generator(11);
  for (int trial = 0; trial < 3000; ++trial) {
    const int width = 4 + static_cast<int>(generator() % 80);
    const int height = 4 + static_cast<int>(generator() % 12);
    const unsigned share = 1 + generator() % 7;
    std::vector<std::string> rows(static_cast<std::size_t>(height),
                                  std::string(static_cast<std::size_t>(width), '.'));
    for (auto& row : rows) {
      for (char& c : row) {
        if (generator() % 8 < share) c = '#';
      }
    }
    const Picture picture(rows);
    const Areas areas = areas_of(picture.dark());
    std::set<int> gone_round;
    for (const Border& border : picture.borders()) {
      std::set<int> passed;
      for (const Pixel& pixel : border) {
        passed.insert(areas.of[static_cast<std::size_t>(pixel.y * width + pixel.x)]);
      }
      ASSERT_EQ(passed.size(), 1U);
      ASSERT_NE(*passed.begin(), 0);
      if (turning(border) >= 0) {
        EXPECT_TRUE(gone_round.insert(*passed.begin()).second) << "twice";
      }
    }
    for (std::size_t i = 1; i < areas.sizes.size(); ++i) {
      // Of up to two pixels' thickness the area within is none, and long ones are left out.
      if (areas.sizes[i] == 1 || areas.sizes[i] > 2 * (width + height)) continue;
      EXPECT_TRUE(gone_round.contains(static_cast<int>(i)));
    }
  }
}

}  // namespace
}  // namespace waymark
