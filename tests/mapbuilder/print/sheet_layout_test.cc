#include "mapbuilder/print/sheet_layout.h"

#include <gtest/gtest.h>

#include <set>

#include "core/marker/marker_layout.h"

namespace waymark {
namespace {

MarkerBatch batch(int markers, double size_m, Family family = Family::tag36h11) {
  MarkerBatch batch{family, {}, size_m};
  for (int i = 0; i < markers; ++i) batch.numbers.push_back(i);
  return batch;
}

/// The paper that belongs to a marker: a white cell on every side of it.
Box with_margin(const PrintedSquare& printed) {
  const MarkerLayout& layout = marker_layout(printed.id.family);
  const double cell = printed.square.width_mm / layout.square_cells();
  const double around = (layout.outside_cells() + 1) * cell;
  return {printed.square.left_mm - around, printed.square.top_mm - around,
          printed.square.width_mm + 2 * around, printed.square.height_mm + 2 * around};
}

bool overlap(const Box& a, const Box& b) {
  constexpr double kTouching = 1e-9;
  return a.left_mm < b.right_mm() - kTouching && b.left_mm < a.right_mm() - kTouching &&
         a.top_mm < b.bottom_mm() - kTouching && b.top_mm < a.bottom_mm() - kTouching;
}

/// The sheets of an order that can be printed.
std::vector<Sheet> laid_out(const std::vector<MarkerBatch>& batches, const Paper& paper) {
  auto sheets = lay_out(batches, paper);
  EXPECT_TRUE(sheets) << sheets.error().message;
  return sheets ? *std::move(sheets) : std::vector<Sheet>(1);
}

struct Order {
  double size_m;
  const char* paper;
};

class Layouts : public testing::TestWithParam<Order> {};

TEST_P(Layouts, EveryMarkerIsThereOnceWithItsMarginAndWherePrintersPrint) {
  const Paper paper = *paper_from_name(GetParam().paper);
  std::set<int> printed;
  for (const Sheet& sheet : laid_out({batch(37, GetParam().size_m)}, paper)) {
    for (const PrintedSquare& square : sheet.squares) {
      EXPECT_TRUE(printed.insert(square.id.number).second);
      EXPECT_NEAR(square.square.width_mm, 1e3 * GetParam().size_m, 1e-9);
      EXPECT_GE(square.square.left_mm, 5 - 1e-9);
      EXPECT_LE(square.square.right_mm(), sheet.paper.width_mm - 5 + 1e-9);
      EXPECT_GE(square.square.top_mm, 5 - 1e-9);
      const Box own = with_margin(square);
      EXPECT_GE(own.left_mm, -1e-9);
      EXPECT_LE(own.right_mm(), sheet.paper.width_mm + 1e-9);
      EXPECT_LE(own.bottom_mm(), sheet.paper.height_mm - 17 + 1e-9) << "the ruler's strip";
      for (const PrintedSquare& other : sheet.squares) {
        EXPECT_TRUE(other.id == square.id || !overlap(own, with_margin(other)));
      }
    }
  }
  EXPECT_EQ(printed.size(), 37U);
}

INSTANTIATE_TEST_SUITE_P(Orders, Layouts,
                         testing::Values(Order{0.16, "a4"}, Order{0.165, "letter"},
                                         Order{0.1, "a4"}, Order{0.03, "a4"}, Order{0.2, "a3"},
                                         Order{0.01, "100x150"}));

TEST(Layout, AllThatAMarkerHasAroundItsSquareIsPrinted) {
  for (const Family family : {Family::tag36h11, Family::tagstandard41h12}) {
    for (const Sheet& sheet : laid_out({batch(5, 0.03, family)}, *paper_from_name("a4"))) {
      for (const PrintedSquare& printed : sheet.squares) {
        const Box whole = with_margin(printed);
        EXPECT_LE(printed.window.left_mm, whole.left_mm + 1e-9);
        EXPECT_LE(printed.window.top_mm, whole.top_mm + 1e-9);
        EXPECT_GE(printed.window.right_mm(), whole.right_mm() - 1e-9);
        EXPECT_GE(printed.window.bottom_mm(), whole.bottom_mm() - 1e-9);
      }
    }
  }
}

TEST(Layout, PaperIsTurnedWhereMoreFitThen) {
  // With its margin and name a marker takes 75 by 82 mm: one on 100 by 150, two on 150 by 100.
  const auto turned = laid_out({batch(2, 0.06)}, {100, 150});
  ASSERT_EQ(turned.size(), 1U);
  EXPECT_EQ(turned.front().paper.width_mm, 150);
  // On 160 by 110 and 110 by 160 as many fit: it stays.
  EXPECT_EQ(laid_out({batch(2, 0.08)}, {110, 160}).front().paper.width_mm, 110);
}

TEST(Layout, ALargeMarkerIsPrintedInPartsThatCoverIt) {
  const MarkerBatch large = batch(1, 0.3);
  const auto sheets = laid_out({large}, Paper{});
  ASSERT_GT(sheets.size(), 1U);
  const double cell = 300.0 / 8;
  // Every point of the marker and its margin is seen through some window.
  constexpr int kPoints = 53;
  const double step = (300 + 2 * cell - 2) / (kPoints - 1);
  for (int i = 0; i < kPoints; ++i) {
    for (int k = 0; k < kPoints; ++k) {
      const double x = 1 - cell + i * step;
      const double y = 1 - cell + k * step;
      bool seen = false;
      for (const Sheet& sheet : sheets) {
        const PrintedSquare& part = sheet.squares.front();
        const double at_x = part.square.left_mm + x;
        const double at_y = part.square.top_mm + y;
        seen = seen || (at_x >= part.window.left_mm && at_x <= part.window.right_mm() &&
                        at_y >= part.window.top_mm && at_y <= part.window.bottom_mm());
      }
      EXPECT_TRUE(seen) << x << ", " << y;
    }
  }
}

TEST(Layout, EverySheetHasARulerOfItsLength) {
  for (const auto& [paper, long_mm] : {std::pair{Paper{210, 297}, 200.0},
                                       {Paper{209, 297}, 100.0},
                                       {Paper{109, 297}, 50.0},
                                       {Paper{59, 100}, 20.0}}) {
    const Sheet sheet = laid_out({batch(1, 0.02)}, paper).front();
    const Line& ruler = sheet.lines.front();
    EXPECT_NEAR(ruler.x1_mm - ruler.x0_mm, long_mm, 1e-9);
  }
}

// Of a window no larger than its overlap with the next there would be parts without end.
TEST(Layout, PaperTooSmallForAPartIsRefused) {
  for (const auto& [width_mm, height_mm] :
       {std::pair{50.0, 50.0}, {54, 54}, {2000, 54}, {54, 2000}, {54.1, 54.1}, {54.0005, 300}}) {
    const auto sheets = lay_out({batch(1, 0.16)}, {width_mm, height_mm});
    ASSERT_FALSE(sheets) << width_mm;
    EXPECT_EQ(sheets.error().kind, ErrorKind::usage);
  }
  EXPECT_TRUE(lay_out({batch(1, 0.16)}, {60, 84}));
  EXPECT_TRUE(lay_out({batch(1, 0.01)}, {50, 54})) << "it needs no parts";
}

TEST(Layout, MoreSheetsThanAPdfHoldsAreRefused) {
  MarkerBatch many = batch(kMostSheets, 0.16);
  EXPECT_EQ(laid_out({many}, Paper{}).size(), static_cast<std::size_t>(kMostSheets));
  many.numbers.push_back(kMostSheets);
  for (const auto& [order, paper] : {std::pair{many, Paper{}}, {batch(40, 5), Paper{60, 100}}}) {
    const auto sheets = lay_out({order}, paper);
    ASSERT_FALSE(sheets);
    EXPECT_EQ(sheets.error().kind, ErrorKind::usage);
  }
}

TEST(Layout, ANameIsNoWiderThanItsMarkersPaper) {
  for (const Sheet& sheet : laid_out({batch(20, 0.02, Family::aruco_4x4_1000)}, Paper{})) {
    const double block_mm = 20.0 * 8 / 6;
    for (std::size_t i = 1; i < sheet.labels.size(); ++i) {
      const Label& label = sheet.labels[i];
      EXPECT_LT(0.5 * label.height_mm * static_cast<double>(label.text.size()), block_mm);
    }
  }
}

}  // namespace
}  // namespace waymark
