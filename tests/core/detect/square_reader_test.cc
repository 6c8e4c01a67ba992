#include "core/detect/square_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/detect/square_finder.h"
#include "core/marker/marker_layout.h"
#include "core/marker/nested_families.h"
#include "tests/support/printed_wall.h"

namespace waymark {
namespace {

using test::Print;

class SquareReaderTest : public ::testing::Test {
 protected:
  /// Numbers that the image's squares show in a form.
  [[nodiscard]] std::set<int> numbers(const GrayImage& image, const SquareForm& form) const {
    std::set<int> read;
    for (const ImageCorners& square : find_squares(image.view())) {
      for (const SquareReading& reading : reader.read(image.view(), square).readings) {
        if (reading.form == form) read.insert(reading.number);
      }
    }
    return read;
  }

  const SquareReader reader;
  const std::set<int> all{0, 1, 2, 3, 4, 5, 6, 7};
};

TEST_F(SquareReaderTest, ReadsEveryFamilyUprightAndMirrored) {
  for (const Family family : SquareReader::families()) {
    Print print;
    print.family = family;
    const GrayImage wall = test::wall_with(print, 0);
    EXPECT_EQ(numbers(wall, {family, false, false}), all) << name_of(family);
    EXPECT_EQ(numbers(test::mirrored(wall), {family, true, false}), all) << name_of(family);
  }
}

TEST_F(SquareReaderTest, MeasuresTheBordersWidth) {
  for (const double border_cells : {0.5, 1.0, 2.0}) {
    Print print;
    print.border_cells = border_cells;
    print.side_px = 96;
    const GrayImage wall = test::wall_with(print, 0);
    int read = 0;
    for (const ImageCorners& square : find_squares(wall.view())) {
      for (const SquareReading& reading : reader.read(wall.view(), square).readings) {
        if (reading.form.family != print.family) continue;
        EXPECT_NEAR(reading.border_cells, border_cells, 0.05);
        EXPECT_EQ(reading.form.other_border, border_cells != 1.0);
        ++read;
      }
    }
    EXPECT_EQ(read, 8) << border_cells;
  }
}

TEST_F(SquareReaderTest, TheFirstCornerIsTheMarkersTopLeft) {
  const GrayImage wall = test::wall_with({}, 0);
  for (const ImageCorners& square : find_squares(wall.view())) {
    for (const SquareReading& reading : reader.read(wall.view(), square).readings) {
      if (reading.form != SquareForm{Family::tag36h11, false, false}) continue;
      const auto corner = [&](int i) {
        return square[static_cast<std::size_t>((reading.first_corner + i) % 4)];
      };
      EXPECT_LT(corner(0).y(), corner(3).y() - 60) << "prints hang upright, turned by 0.2 at most";
      EXPECT_LT(corner(0).x(), corner(1).x() - 60);
    }
  }
}

TEST_F(SquareReaderTest, ChanceIsThatOfTheFamily) {
  const SquareForm weak{Family::aruco_4x4_1000, false, false};
  EXPECT_NEAR(reader.chance_of(weak, true), 4.0 * 1000 / 65536, 1e-12);
  EXPECT_EQ(reader.chance_of(weak, true), reader.chance_of(weak, false)) << "none is corrected";
  const SquareForm strong{Family::tag36h11, true, false};
  EXPECT_LT(reader.chance_of(strong, true), 1e-7);
  EXPECT_LT(reader.chance_of(strong, true), reader.chance_of(strong, false));
  for (const Family family : SquareReader::families()) {
    EXPECT_GT(reader.chance_of({family, false, false}, true), 0) << name_of(family);
  }
}

TEST_F(SquareReaderTest, AFamilyOfBlackSquaresIsReadByTheLargestThatBeginsWithIt) {
  const auto families = SquareReader::families();
  for (const FamilyTraits& family : all_families()) {
    const Family largest = largest_beginning_with(family.family);
    EXPECT_EQ(std::count(families.begin(), families.end(), largest),
              marker_layout(family.family).is_light() ? 0 : 1)
        << family.name;
  }
}

TEST_F(SquareReaderTest, WhatHasNoDarkRimOrIsNoSquareReadsAsNothing) {
  const GrayImage grey(100, 100, 128);
  const ImageCorners square{{{20, 20}, {80, 20}, {80, 80}, {20, 80}}};
  EXPECT_TRUE(reader.read(grey.view(), square).readings.empty());
  const ImageCorners line{{{20, 20}, {40, 20}, {60, 20}, {80, 20}}};
  EXPECT_TRUE(reader.read(grey.view(), line).readings.empty());
  const ImageCorners outside{{{-500, -500}, {900, -500}, {900, 900}, {-500, 900}}};
  EXPECT_TRUE(reader.read(grey.view(), outside).readings.empty());
}

}  // namespace
}  // namespace waymark
